"""The priority of the programs between key and wheel: where the system grants it, and where it does not."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.avr import avr_robot
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program
from tests.support.ros import RosMaster, ros_master

__all__ = ["ros_master"]

TAKE = """
import os, threading, time
{before}
from laser_bot_battle import priority
from laser_bot_battle.log import configure_logging
configure_logging("info")
priority.take({wanted})
def work():
    end = time.monotonic() + 60
    while time.monotonic() < end and {busy} and os.sched_getscheduler(0) == os.SCHED_RR:
        pass
    print(os.sched_getscheduler(0), flush=True)
thread = threading.Thread(target=work)
thread.start()
thread.join()
"""
# root may take any priority; without that one capability it is as everybody
WITHOUT_RIGHT = ["setpriv", "--bounding-set=-sys_nice"] if os.geteuid() == 0 else []
granted = pytest.mark.skipif(os.geteuid() != 0, reason="only root is sure to be granted a real-time priority")


def take(wanted: int, busy: bool = False, without_right: bool = False, before: str = "") -> tuple[int, str]:
    """The scheduler of a thread of the program, and its log."""
    command = [sys.executable, "-c", TAKE.format(wanted=wanted, busy=busy, before=before)]
    env = {**os.environ, "PYTHONPATH": str(ROOT / "build" / "python")}
    result = subprocess.run(
        WITHOUT_RIGHT * without_right + command, env=env, capture_output=True, text=True, check=True, timeout=300
    )
    return int(result.stdout), result.stderr


@granted
def test_a_program_takes_the_priority_and_says_so_in_one_line() -> None:
    scheduler, log = take(1)
    assert scheduler == os.SCHED_RR
    assert log.count("\n") == 1
    assert log.endswith("runs at real-time priority 1\n")


def test_it_goes_on_as_usual_where_the_system_does_not_grant_it() -> None:
    assert take(1, without_right=True) == (os.SCHED_OTHER, "")


def test_it_takes_none_when_it_is_told_so() -> None:
    assert take(0) == (os.SCHED_OTHER, "")


@granted
def test_a_program_that_never_pauses_gives_it_back() -> None:
    scheduler, log = take(1, busy=True)
    assert scheduler == os.SCHED_OTHER
    assert "has worked for 0.5 s without a pause: goes on at the usual priority" in log


def test_it_takes_none_when_threads_are_there_that_could_not_give_it_back() -> None:
    scheduler, log = take(1, before="threading.Thread(target=time.sleep, args=[60], daemon=True).start()")
    assert scheduler == os.SCHED_OTHER
    assert "libraries have started threads" in log


def priorities(process: int) -> set[int]:
    """Of all its threads."""
    return {os.sched_getscheduler(int(thread)) for thread in os.listdir(f"/proc/{process}/task")}


@granted
def test_simulator_serial_node_and_rosbridge_run_at_it(ros_master: RosMaster, tmp_path: Path) -> None:
    def all_threads(program: Program, ready: str) -> set[int]:
        program.wait_for(ready)
        return priorities(program.process.pid)

    with avr_robot("--serial", tmp_path / "tty") as robot:
        assert priorities(robot.program.process.pid) == {os.SCHED_RR}
        node = Program.python("robot.serial_node", str(tmp_path / "tty"), "__name:=Robot0", env=ros_master.env)
        bridge = Program.python("server.rosbridge", "--port", str(free_port()), env=ros_master.env)
        try:
            assert all_threads(node, "/command (") == {os.SCHED_RR}
            assert all_threads(bridge, "listening") == {os.SCHED_RR}
        finally:
            node.kill()
            bridge.kill()
