"""The relay as its users find it: a process between a real ROS master, cameras, and real WebSockets."""

from collections.abc import Callable, Iterator, Mapping
from itertools import count
from types import TracebackType
from typing import Self

import pytest

from laser_bot_battle.master import Master
from laser_bot_battle.names import camera_parameter
from tests.integration.rosbridge.ends import RosSide
from tests.support.fake_camera import FakeCamera
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster, own_master, ros_master
from tests.support.viewer import Viewer

__all__ = ["own_master", "ros_master"]

STOPPED, COUNTDOWN, PLAYING = 0, 1, 2


class Relay:
    """`python3 -m server.camera` on a free port. In a `with` it listens, and ends without a traceback."""

    def __init__(self, master: RosMaster, **variables: str) -> None:
        self.port = free_port()
        settings = {"LASERBOT_RELAY_PORT": str(self.port), "LASERBOT_OPERATOR_TOKEN": "the operators' token"}
        self.program = Program.python("server.camera", env={**master.env, **settings, **variables})

    def __enter__(self) -> Self:
        try:
            self.program.wait_for("listening")
        except BaseException:
            self.program.kill()
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, value: object, trace: TracebackType | None) -> None:
        self.program.stop()
        assert "Traceback" not in self.program.output, self.program.output


def tell_camera(master: RosMaster, robot: int, url: str) -> None:
    """The robot has told the ROS master where its camera is."""
    Master(master.uri, "test").call("setParam", camera_parameter(robot), url)


@pytest.fixture(scope="module")
def relay(ros_master: RosMaster) -> Iterator[Relay]:
    """One relay for all tests of a module: everybody in them comes from the same address."""
    with Relay(ros_master, LASERBOT_RELAY_VIEWERS="400") as relay:
        yield relay


@pytest.fixture(scope="module")
def referee(ros_master: RosMaster) -> Iterator[RosSide]:
    """Speaks by `status`; in the beginning, no battle is running and nobody is signed in."""
    side = RosSide(ros_master.env)
    side.status(STOPPED)
    yield side
    side.close()


@pytest.fixture(scope="module")
def robots() -> Iterator[int]:
    """Their IDs: each test has robots of its own, so that no camera of an earlier one lingers."""
    return count(1)


@pytest.fixture
def camera(ros_master: RosMaster, robots: Iterator[int]) -> Iterator[Callable[..., tuple[int, FakeCamera]]]:
    """Starts robots' cameras: the robot's ID, and its camera."""
    cameras: list[FakeCamera] = []

    def start(rate: float = 20.0, size: int = 10_000) -> tuple[int, FakeCamera]:
        robot = next(robots)
        cameras.append(FakeCamera(rate, size))
        cameras[-1].start()
        tell_camera(ros_master, robot, cameras[-1].url)
        return robot, cameras[-1]

    yield start
    for started in cameras:
        started.stop()


@pytest.fixture
def viewer(relay: Relay, referee: RosSide) -> Iterator[Callable[..., Viewer]]:
    """Connects viewers (`token` for the session cookie, and further headers); all are closed after the test."""
    viewers: list[Viewer] = []

    def connect(token: str = "", headers: Mapping[str, str] | None = None, receive_buffer: int = 0) -> Viewer:
        viewers.append(Viewer(relay.port, token, headers, receive_buffer=receive_buffer))
        return viewers[-1]

    yield connect
    for connected in viewers:
        connected.close()
    referee.status(STOPPED)
