"""A real ROS master for tests, on a free port, with its files in a folder of the test's own.

A test package makes the fixture its own by importing it in its conftest.py:

    from tests.support.ros import ros_master
"""

import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.polling import until
from tests.support.ports import free_port, listening
from tests.support.programs import ROOT, Program

HOST = "127.0.0.1"


class RosMaster:
    """The master's own; `env` is what ROS programs need in their environment to use it."""

    PROGRAM: tuple[str, ...] = ("-m", "server.ros.master")

    def __init__(self, folder: Path) -> None:
        self.port = free_port()
        self.uri = f"http://{HOST}:{self.port}"
        self.env = {
            "ROS_MASTER_URI": self.uri,
            "ROS_IP": HOST,
            "ROS_HOSTNAME": HOST,
            "ROS_HOME": str(folder),
            "ROS_LOG_DIR": str(folder / "log"),
            "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "build" / "python")]),
        }
        self._program: Program | None = None

    @property
    def pid(self) -> int:
        """Of its process, while it runs."""
        assert self._program
        return self._program.process.pid

    def start(self) -> None:
        self._program = Program([sys.executable, *self.PROGRAM, "-p", str(self.port)], self.env)
        until(lambda: listening(self.port), 10, "the ROS master")

    def stop(self) -> None:
        """All that it knew is lost; start() begins again on the same port."""
        if self._program is not None:
            self._program.stop()
            self._program = None

    def pause(self) -> None:
        """It hangs until resume()."""
        assert self._program
        self._program.process.send_signal(signal.SIGSTOP)

    def resume(self) -> None:
        assert self._program
        self._program.process.send_signal(signal.SIGCONT)


@pytest.fixture(scope="module")
def ros_master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RosMaster]:
    """One master for a module: its tests use node and topic names of their own."""
    master = RosMaster(tmp_path_factory.mktemp("ros"))
    master.start()
    try:
        yield master
    finally:
        master.stop()


@pytest.fixture
def own_master(tmp_path: Path) -> Iterator[RosMaster]:
    """A master, not started yet, that the test may stop and start."""
    master = RosMaster(tmp_path / "ros")
    yield master
    master.stop()
