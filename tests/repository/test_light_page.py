"""docs/protocol-light.md in itself and against its constants; the firmware's packets: test_firmware_light.py."""

import pytest

from laser_bot_battle.light_protocol import COOLDOWN, DAMAGES, PLAIN_PERIOD
from tests.support.documents import Row, page, table, value_of

PAGE = page("protocol-light.md")
MARKS = {"0": 600, "1": 1200}  # us
SPACE = 600
HEADER = 2400


@pytest.mark.parametrize("row", table(PAGE, "Times"), ids=lambda row: row["what"])
def test_times_are_those_of_the_code(row: Row) -> None:
    assert float(row["value"].split()[0]) == value_of(row["where"])


@pytest.mark.parametrize("row", table(PAGE, "Packets"), ids=lambda row: row["bits"])
def test_a_packet_is_made_as_the_page_says(row: Row) -> None:
    shooter, team, damage = int(row["shooter"]), int(row["team"]), int(row["damage"])
    assert row["bits"] == f"0{shooter:07b}{team:02b}{damage:04b}"
    bits = [us for bit in row["bits"] for us in (SPACE, MARKS[bit])]
    assert row["light"] == " ".join(map(str, [HEADER, *bits]))


def test_the_damage_table_is_that_of_the_code() -> None:
    assert tuple(int(row["damage"]) for row in table(PAGE, "Damage")) == DAMAGES


def test_the_master_counts_with_the_times_of_the_robots() -> None:
    times = {row["what"]: float(row["value"].split()[0]) / 1000 for row in table(PAGE, "Times")}
    assert times["cooldown, until the server says another"] == COOLDOWN
    assert times["a shot of plain light"] + times["darkness between two shots, at least"] == PLAIN_PERIOD
