"""The log: one line per event, also when rospy has lost a connection."""

import json
import logging
import traceback
from collections.abc import Iterator

import pytest

from laser_bot_battle.log import configure_logging


@pytest.fixture(autouse=True)
def logging_as_before() -> Iterator[None]:
    """The root logger is the whole test run's: give it back as it was."""
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    root.handlers = []
    yield
    root.handlers, root.level = handlers, level


def test_rospys_traceback_becomes_one_line_that_says_what_and_why(capsys):
    configure_logging("info")
    try:
        raise ConnectionRefusedError(111, "Connection refused")
    except OSError:
        logging.getLogger("rospy.internal").warning("Unknown error to a:1: %s", traceback.format_exc())
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert lines[0].endswith("Unknown error to a:1:  ConnectionRefusedError: [Errno 111] Connection refused")


def test_the_level_is_obeyed_and_handlers_are_not_doubled(capsys):
    configure_logging("warning")
    configure_logging("warning")
    logging.getLogger("server.x").info("quiet")
    logging.getLogger("server.x").warning("loud")
    assert [line.split(": ")[-1] for line in capsys.readouterr().err.splitlines()] == ["loud"]


def test_our_own_failures_keep_their_traceback(capsys):
    configure_logging("info")
    try:
        raise KeyError("ours")
    except KeyError:
        logging.getLogger("server.x").exception("failed")
    assert "Traceback" in capsys.readouterr().err


def test_what_strangers_send_cannot_look_like_another_line(capsys):
    configure_logging("info")
    for forged in ("a\n2026-01-01 ERROR x: y", "a\r\x1b[2J", "a\u2028b\x85c\u202ed", "\udcff"):
        logging.getLogger("any.logger").info("robot %s", forged)
    text = capsys.readouterr().err
    assert len(text.splitlines()) == 4
    assert text.replace("\n", "").isprintable()
    assert r"robot a\n2026-01-01 ERROR x: y" in text
    try:
        raise ValueError("a\n2026-01-01 ERROR x: y")
    except ValueError:
        logging.getLogger("any.logger").exception("failed")
    first, *rest = capsys.readouterr().err.splitlines()
    assert first.endswith("any.logger: failed")
    assert all(line.startswith("  ") for line in rest)


def test_a_long_text_is_cut(capsys):
    configure_logging("info")
    logging.getLogger("any.logger").info("x" * 1_000_000)
    assert len(capsys.readouterr().err) < 5000


@pytest.mark.parametrize(
    "logger", ["server.web.api", "waitress", "rosout", "xmlrpc", "rosmaster.master", "asyncio", "robot.serial.line"]
)
def test_strangers_have_a_budget_of_lines_and_what_is_left_out_is_counted(capsys, monkeypatch, logger):
    configure_logging("info")
    now = [100.0]
    monkeypatch.setattr("laser_bot_battle.log.time.monotonic", lambda: now[0])
    for number in range(1254):
        logging.getLogger(logger).warning("refused %d", number)
    assert len(capsys.readouterr().err.splitlines()) == 20
    logging.getLogger("server.main").info("others speak")
    now[0] += 1.0
    logging.getLogger(logger).warning("refused")
    logging.getLogger(logger).warning("refused")
    lines = capsys.readouterr().err.splitlines()
    assert [line.rpartition(": ")[2] for line in lines] == ["others speak", "refused (and 1,234 more like this)"]


def test_what_fails_again_and_again_is_told_without_its_traceback(capsys, monkeypatch):
    configure_logging("info")
    now = [100.0]
    monkeypatch.setattr("laser_bot_battle.log.time.monotonic", lambda: now[0])
    for _ in range(9_000):
        now[0] += 1 / 128
        try:
            raise OSError(24, "Too many open files")
        except OSError:
            logging.getLogger("asyncio").exception("socket.accept() out of system resource")
    told = capsys.readouterr().err
    assert told.count("Traceback") <= 21
    assert len(told) < 9_000 / 128 * 150 + 20_000, "bytes: 150 a second, and the first ones whole"


def test_a_program_can_read_each_line_and_which_battle_and_robot_it_is_about(capsys, monkeypatch):
    monkeypatch.setenv("LASERBOT_LOG_FORMAT", "json")
    configure_logging("info", robot=3)
    about = {"event": "HitCounted", "battle": 7, "robot": 1}
    logging.getLogger("server.game.loop").info("a\nhit", extra={"fields": about})
    try:
        raise ValueError("a\nb")
    except ValueError:
        logging.getLogger("any.logger").exception("failed")
    hit, failure = map(json.loads, capsys.readouterr().err.splitlines())
    assert hit.items() >= {"level": "info", "logger": "server.game.loop", "message": r"a\nhit", **about}.items()
    assert failure["robot"] == 3
    assert "ValueError" in failure["traceback"]


def test_an_unknown_format_ends_the_program_with_a_word(capsys, monkeypatch):
    monkeypatch.setenv("LASERBOT_LOG_FORMAT", "xml")
    with pytest.raises(SystemExit, match="2"):
        configure_logging("info")
    assert "LASERBOT_LOG_FORMAT=xml: must be one of text, json" in capsys.readouterr().err
