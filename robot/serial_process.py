"""The serial node as a child of the supervisor. It has a process group of its own: Ctrl-C reaches the supervisor only,
which then ends it."""

import os
import subprocess
import sys
import threading
import time

from laser_bot_battle.names import (
    command_topic,
    hit_topic,
    identify_topic,
    response_topic,
    robot_node,
    setup_topic,
)
from laser_bot_battle.place import Place
from robot.rosserial.host import ANSWER_EXPECTED
from robot.serial.connection import file_number, is_inherited

STOP_TIMEOUT = 1.0  # s
NO_ANSWER = 3  # exit code: the device has not answered at all


class SerialNode:
    """`python3 -m robot.serial_node` as the ROS node Robot<ID>; a context manager that ends it."""

    def __init__(self, device: str, robot_id: int, place: Place) -> None:
        self.device = device
        self._words = [
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
        ]
        self._environment = {**os.environ, **place.environment()}
        self._start()

    def _start(self, *further: str) -> None:
        self._started = time.monotonic()
        words = [*self._words, *further]
        files = [file_number(self.device)] if is_inherited(self.device) else []
        self._process = subprocess.Popen(
            words, env=self._environment, stdin=subprocess.PIPE, process_group=0, pass_fds=files
        )
        # A signal that interrupts poll() or wait() may leave their lock held for ever. It interrupts no other thread
        # than the main one.
        self._waiter = threading.Thread(target=self._process.wait, name="serial node", daemon=True)
        self._waiter.start()

    def start_again(self) -> None:
        """It has ended. The device is no longer starting: if it takes long to answer now, something is wrong."""
        self._let_go()
        self._start("--answer-within", f"{ANSWER_EXPECTED:g}")

    @property
    def age(self) -> float:
        """s since its last start."""
        return time.monotonic() - self._started

    def __enter__(self) -> "SerialNode":
        return self

    def __exit__(self, *_: object) -> None:
        """Politely, then by force."""
        if self.exit_code is None:
            self._process.terminate()
            self._waiter.join(STOP_TIMEOUT)
            if self.exit_code is None:
                self._process.kill()
                self._waiter.join()
        self._let_go()

    def _let_go(self) -> None:
        assert self._process.stdin
        self._process.stdin.close()

    @property
    def exit_code(self) -> int | None:
        """None while it runs, negative if a signal ended it."""
        return self._process.returncode
