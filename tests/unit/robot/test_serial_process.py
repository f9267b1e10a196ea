"""The supervisor's hold on its serial node; a shell stands for the node."""

import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from laser_bot_battle.place import Place
from robot.serial_process import SerialNode
from tests.support.polling import until

MASTER = Place(host="127.0.0.1", web=5000, ros_master_uri="http://127.0.0.1:11311")


def a_node(monkeypatch: pytest.MonkeyPatch, folder: Path, script: str) -> SerialNode:
    program = folder / "node"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(program))
    return SerialNode("/dev/ttyACM0", 7, MASTER)


@pytest.fixture
def interrupting() -> Iterator[None]:
    """SIGPROF interrupts, as Ctrl-C does."""
    before = signal.signal(signal.SIGPROF, signal.default_int_handler)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0)
    signal.signal(signal.SIGPROF, before)


def look_again_and_again(node: SerialNode) -> None:
    """A function of its own: Python 3.13 lets a `with` miss what is raised where a loop in it begins again."""
    while node.exit_code is None:
        pass


def test_it_is_ended_whatever_a_signal_has_interrupted(
    interrupting: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with a_node(monkeypatch, tmp_path, "exec sleep 60") as node:
        for _ in range(50):  # one in five has left a lock held, when this was Popen.poll()
            with pytest.raises(KeyboardInterrupt):
                signal.setitimer(signal.ITIMER_PROF, 0.0001)
                look_again_and_again(node)
    assert node.exit_code == -signal.SIGTERM


def test_one_that_does_not_end_is_killed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with a_node(monkeypatch, tmp_path, f"trap '' TERM; touch {tmp_path}/deaf; read word") as node:
        until((tmp_path / "deaf").exists)
    assert node.exit_code == -signal.SIGKILL


def test_its_exit_code_is_known_once_it_has_ended(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with a_node(monkeypatch, tmp_path, "exit 3") as node:
        until(lambda: node.exit_code == 3)
