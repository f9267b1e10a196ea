"""The logs of all hosts, read from real journals."""

import json
from pathlib import Path

import pytest

from server.web.journal import Journals, Line, NothingToReadError
from tests.support.journals import KERNEL, from_container, write_journal

NOW = 1_800_000_000.0


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The master's own journal, and that of a robot, whose lines are older."""
    text = "2026-11-25 10:00:00,123 WARNING robot.serial_node: the Arduino is silent"
    told = {"level": "info", "logger": "robot.camera", "message": "a camera is there"}
    chatter = {"SYSLOG_IDENTIFIER": "systemd", "PRIORITY": "6", "MESSAGE": "Started something."}
    login = {"SYSLOG_IDENTIFIER": "sshd-session", "PRIORITY": "3", "MESSAGE": "pam_env: no file"}
    robot = [
        from_container("laserbot-robot", text),
        from_container("laserbot-camera", json.dumps(told)),
        KERNEL,
        chatter,
        login,
    ]
    write_journal(tmp_path / "remote", "raspberrypi1", robot, NOW - 60)
    write_journal(tmp_path / "0123", "laser-bot-master", [from_container("laserbot-front", "started\x1b[31m")], NOW)
    return tmp_path


def test_all_hosts_speak_the_newest_first(folder: Path) -> None:
    journals = Journals(folder)
    assert journals.hosts() == ["laser-bot-master", "raspberrypi1"]
    assert journals.newest(10) == [
        Line(NOW, "laser-bot-master", "laserbot-front", "info", "started\\x1b[31m"),
        Line(NOW - 62, "raspberrypi1", "kernel", "error", "Under-voltage detected!"),
        Line(NOW - 63, "raspberrypi1", "laserbot-camera", "info", "robot.camera: a camera is there"),
        Line(NOW - 64, "raspberrypi1", "laserbot-robot", "warning", "robot.serial_node: the Arduino is silent"),
    ]


def test_one_host_only_warnings_and_no_more_than_wanted(folder: Path) -> None:
    journals = Journals(folder)
    warnings = journals.newest(10, "raspberrypi1", only_warnings=True)
    assert [line.program for line in warnings] == ["kernel", "laserbot-robot"]
    assert journals.newest(1, "raspberrypi1") == warnings[:1]
    assert journals.newest(10, "raspberrypi2") == []


def test_what_is_no_line_of_ours_is_shown_as_it_is(tmp_path: Path) -> None:
    said = ["{", '{"level": "loud"}', "[1]", '"text"', "2026-11-25 10:00:00,123 LOUD x"]
    write_journal(tmp_path, "pi", [from_container("laserbot-robot", text) for text in said])
    assert [(line.level, line.text) for line in Journals(tmp_path).newest(9)] == [
        ("info", "x" if text.endswith("LOUD x") else text) for text in reversed(said)
    ]


def test_a_torn_journal_hides_no_other(folder: Path) -> None:
    journals = Journals(folder)
    known = journals.newest(10)
    (folder / "remote" / "remote-empty.journal").touch()
    (folder / "remote" / "remote-torn.journal").write_bytes(b"x" * 1000)
    assert journals.newest(10) == known
    assert journals.hosts() == ["laser-bot-master", "raspberrypi1"]


@pytest.mark.parametrize("name", ["", "not-there"])
def test_nothing_to_read_is_said(tmp_path: Path, name: str) -> None:
    with pytest.raises(NothingToReadError, match=str(tmp_path / name)):
        Journals(tmp_path / name).newest(1)
