"""robots.json: read, written whole, and survived when it is broken."""

import json

import pytest

from server.store.roster import Roster

FIXED = {"/id_service_client_pi": 1, "/id_service_client_pi_2": 2}


def test_what_is_saved_is_loaded_and_the_folder_is_made(tmp_path):
    roster = Roster(tmp_path / "new" / "folder")
    assert roster.load() == {}
    roster.save({"/a": 0, "/b": 127})
    assert Roster(tmp_path / "new" / "folder").load() == {"/a": 0, "/b": 127}


def test_saving_leaves_only_the_file(tmp_path):
    Roster(tmp_path).save({"/a": 0})
    Roster(tmp_path).save({"/a": 1})
    assert [path.name for path in tmp_path.iterdir()] == ["robots.json"]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "null",
        '{"/a": "0"}',
        '{"/a": 128}',
        '{"/a": -1}',
        '{"/a": true}',
        '{"/a": 1.0}',
        '{"/a": null}',
        "[" * 100_000,
    ],
)
def test_a_broken_file_is_kept_aside_and_robots_start_afresh(tmp_path, text, caplog):
    roster = Roster(tmp_path)
    roster.path.write_text(text)
    assert roster.load() == {}
    assert (tmp_path / "robots.json.broken").read_text() == text
    assert "broken" in caplog.text
    roster.save({"/a": 3})
    assert roster.load() == {"/a": 3}


def test_a_file_that_is_no_text_is_broken_too(tmp_path):
    roster = Roster(tmp_path)
    roster.path.write_bytes(b"\xff\xfe\x00")
    assert roster.load() == {}
    assert (tmp_path / "robots.json.broken").exists()


def test_a_folder_that_cannot_be_written_is_logged_and_nothing_else(tmp_path, caplog):
    (tmp_path / "file").write_text("in the way")
    Roster(tmp_path / "file").save({"/a": 0})
    assert "cannot write" in caplog.text
    assert "Traceback" not in caplog.text


def test_a_file_that_cannot_be_read_is_logged_and_left_alone(tmp_path, caplog):
    roster = Roster(tmp_path)
    roster.path.mkdir()
    assert roster.load() == {}
    assert "cannot read" in caplog.text
    assert roster.path.is_dir()


def test_the_file_is_plain_json_that_an_operator_can_edit(tmp_path):
    roster = Roster(tmp_path)
    roster.save({"/b": 1, "/a": 0})
    assert json.loads(roster.path.read_text()) == {"/a": 0, "/b": 1}
    assert roster.path.read_text().splitlines()[1] == '  "/a": 0,'


def test_what_the_operator_fixed_goes_before_the_file(tmp_path):
    Roster(tmp_path).save({"/a": 0, "/b": 1, "/c": 2})
    assert Roster(tmp_path, {"/b": 7, "/new": 2}).load() == {"/a": 0, "/b": 7, "/new": 2}


def test_a_default_name_of_a_fixed_robot_is_warned_of_once(tmp_path, caplog):
    roster = Roster(tmp_path, FIXED)
    for _ in range(2):
        roster.warn_of_lookalike("/id_service_client_pi_2_b8_27_eb_00_00_01")
    (record,) = caplog.records
    assert record.levelname == "WARNING"
    assert "pi_2_b8_27_eb_00_00_01 is not the pi_2 of LASERBOT_ROSTER" in record.message


@pytest.mark.parametrize("name", ["pi", "pi_2", "pi3", "p"])
def test_other_names_are_not_warned_of(tmp_path, caplog, name):
    Roster(tmp_path, FIXED).warn_of_lookalike(f"/id_service_client_{name}")
    assert not caplog.records
