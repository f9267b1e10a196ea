"""IDs that the operator has fixed, and those that older versions have kept in robots.json."""

import pytest

from server.store.roster import Roster, take_over_file

FIXED = {"/id_service_client_pi": 1, "/id_service_client_pi_2": 2}


def test_what_is_fixed_goes_before_what_was_kept():
    assert Roster({"/b": 7, "/new": 2}).with_fixed({"/a": 0, "/b": 1, "/c": 2}) == {"/a": 0, "/b": 7, "/new": 2}


def test_a_file_is_taken_over_once(tmp_path):
    (tmp_path / "robots.json").write_text('{"/a": 0, "/b": 127}')
    assert take_over_file(tmp_path) == {"/a": 0, "/b": 127}
    assert [path.name for path in tmp_path.iterdir()] == ["robots.json.imported"]
    assert take_over_file(tmp_path) == {}


def test_no_file_and_no_folder_is_nothing(tmp_path):
    assert take_over_file(tmp_path / "missing") == {}


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"[]",
        b"null",
        b'{"/a": "0"}',
        b'{"/a": 128}',
        b'{"/a": -1}',
        b'{"/a": true}',
        b'{"/a": 1.0}',
        b'{"/a": null}',
        b"[" * 100_000,
        b"\xff\xfe\x00",
    ],
)
def test_a_broken_file_is_kept_aside(tmp_path, content, caplog):
    (tmp_path / "robots.json").write_bytes(content)
    assert take_over_file(tmp_path) == {}
    assert (tmp_path / "robots.json.broken").read_bytes() == content
    assert "broken" in caplog.text


def test_a_file_that_cannot_be_read_is_logged_and_left_alone(tmp_path, caplog):
    (tmp_path / "robots.json").mkdir()
    assert take_over_file(tmp_path) == {}
    assert "cannot read" in caplog.text
    assert (tmp_path / "robots.json").is_dir()


def test_a_default_name_of_a_fixed_robot_is_warned_of_once(caplog):
    roster = Roster(FIXED)
    for _ in range(2):
        roster.warn_of_lookalike("/id_service_client_pi_2_b8_27_eb_00_00_01")
    (record,) = caplog.records
    assert record.levelname == "WARNING"
    assert "pi_2_b8_27_eb_00_00_01 is not the pi_2 of LASERBOT_ROSTER" in record.message


@pytest.mark.parametrize("name", ["pi", "pi_2", "pi3", "p"])
def test_other_names_are_not_warned_of(caplog, name):
    Roster(FIXED).warn_of_lookalike(f"/id_service_client_{name}")
    assert not caplog.records
