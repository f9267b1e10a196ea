"""The log: one line per event, also when rospy has lost a connection."""

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
