"""docs/discovery.md and the announcement itself."""

from laser_bot_battle.announcement import MAX_ADDRESSES, SERVICE, Announcement, read
from laser_bot_battle.names import ROS_PORT, ROSBRIDGE_PORT, WEB_PORT
from tests.support.documents import page, table


def test_the_records_on_the_page_are_what_is_announced_and_read() -> None:
    records = {row["record"]: row["example"] for row in table(page("discovery.md"), "What is announced")}
    text = {name.removeprefix("TXT "): value for name, value in records.items() if name.startswith("TXT ")}
    announcement = read(
        records["PTR"], int(records["SRV"]), {k.encode(): v.encode() for k, v in text.items()}, [records["A"]]
    )
    assert announcement == Announcement("hall", (records["A"],), WEB_PORT, ROSBRIDGE_PORT, ROS_PORT, text["version"])
    assert announcement.text() == text


def test_the_page_names_the_service_and_its_bounds() -> None:
    text = page("discovery.md")
    assert f"`{SERVICE}`" in text
    assert f"at most {MAX_ADDRESSES}" in text
