"""The programs that the supervisor starts: the serial node, and the one that asks for an ID.

Each is in a process group of its own, so that Ctrl-C reaches the supervisor only, which ends them in order.
"""

import os
import select
import subprocess
import sys
import time
from collections.abc import Callable

from laser_bot_battle.names import (
    command_topic,
    hit_topic,
    identify_topic,
    key_digest,
    response_topic,
    robot_node,
    setup_topic,
)
from laser_bot_battle.place import Place

POLL = 0.05  # s
ANSWER_TIMEOUT = 30.0  # s for the ID; a small Raspberry Pi that has just been switched on may start rospy for 10 s
STOP_TIMEOUT = 1.0  # s


class RegistrationError(Exception):
    """The server gave no ID; the text says why."""


class SerialNode:
    """`python3 -m robot.serial_node` as the ROS node Robot<ID>; a context manager that ends it."""

    def __init__(self, device: str, robot_id: int, place: Place) -> None:
        self._process = subprocess.Popen(
            [
                sys.executable,
                "-m",
                "robot.serial_node",
                device,
                "--end-with-stdin",
                f"__name:={robot_node(robot_id)}",
                f"command:={command_topic(robot_id)}",
                f"response:={response_topic(robot_id)}",
                f"hit:={hit_topic(robot_id)}",
                f"setup:={setup_topic(robot_id)}",
                f"identify:={identify_topic(robot_id)}",
            ],
            env={**os.environ, **place.environment()},
            stdin=subprocess.PIPE,
            process_group=0,
        )

    def __enter__(self) -> "SerialNode":
        return self

    def __exit__(self, *_: object) -> None:
        stop(self._process)

    @property
    def exit_code(self) -> int | None:
        """None while it runs, negative if a signal ended it."""
        return self._process.poll()


def register(place: Place, key: str, wanted: Callable[[], bool]) -> int:
    """Ask the server there for this robot's ID, whose pings will show `key`; RegistrationError says why there is none.

    Gives up as soon as `wanted` says no, and returns as soon as the ID is there: the server waits for the first ping.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "robot.register", key_digest(key)],
        env={**os.environ, **place.environment()},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        process_group=0,
    )
    try:
        return _answer(process, wanted)
    finally:
        process.kill()  # it has nothing to tidy up, and on a slow machine would take a second to end
        stop(process)


def _answer(process: "subprocess.Popen[bytes]", wanted: Callable[[], bool]) -> int:
    """The ID that it prints, or RegistrationError."""
    assert process.stdout
    deadline = time.monotonic() + ANSWER_TIMEOUT
    said = b""
    while not said.endswith(b"\n"):
        if not wanted():
            raise RegistrationError("not needed any more")
        if time.monotonic() > deadline:
            raise RegistrationError(f"no answer from the ROS master or the server within {ANSWER_TIMEOUT:g} s")
        if select.select([process.stdout], [], [], POLL)[0]:
            data = os.read(process.stdout.fileno(), 4096)
            if not data:
                break
            said += data
    last = said.decode(errors="replace").strip().rpartition("\n")[2]
    if last.isascii() and last.isdigit():
        return int(last)
    if last:
        raise RegistrationError(f"the server answered with the ID {last}")
    errors = process.communicate()[1].decode(errors="replace").strip().splitlines()
    raise RegistrationError(errors[-1] if errors else f"robot.register ended with exit code {process.returncode}")


def stop(process: "subprocess.Popen[bytes]") -> None:
    """End a child: politely, then by force."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(STOP_TIMEOUT)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream is not None:
            stream.close()
