"""rosbridge as its users find it: a process between a real ROS master and real WebSockets."""

from collections.abc import Callable, Iterator

import pytest

from tests.integration.rosbridge.ends import Client, RosSide
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster, own_master, ros_master

__all__ = ["own_master", "ros_master"]


class Rosbridge:
    """`python3 -m server.rosbridge` on a free port."""

    def __init__(self, master: RosMaster, **variables: str) -> None:
        self.port = free_port()
        settings = {"LASERBOT_ROSBRIDGE_PORT": str(self.port), "LASERBOT_OPERATOR_TOKEN": "the operators' token"}
        self.program = Program.python("server.rosbridge", env={**master.env, **settings, **variables})


@pytest.fixture(scope="module")
def start_rosbridge(ros_master: RosMaster) -> Iterator[Callable[..., Rosbridge]]:
    """Starts rosbridges; all are ended, and none may have written a traceback."""
    started: list[Rosbridge] = []

    def start(**variables: str) -> Rosbridge:
        started.append(Rosbridge(ros_master, **variables))
        started[-1].program.wait_for("listening")
        return started[-1]

    yield start
    for rosbridge in started:
        rosbridge.program.stop()
        assert "Traceback" not in rosbridge.program.output, rosbridge.program.output


@pytest.fixture(scope="module")
def rosbridge(start_rosbridge: Callable[..., Rosbridge]) -> Rosbridge:
    """One rosbridge for all tests of a module."""
    return start_rosbridge()


@pytest.fixture(scope="module")
def ros(ros_master: RosMaster) -> Iterator[RosSide]:
    """The referee and the robots for all tests of a module."""
    side = RosSide(ros_master.env)
    yield side
    side.close()


@pytest.fixture
def client(rosbridge: Rosbridge) -> Iterator[Callable[..., Client]]:
    """Connects clients (`token` for the session cookie, further headers by name); all are closed after the test."""
    clients: list[Client] = []

    def connect(token: str = "", **headers: str) -> Client:
        clients.append(Client(rosbridge.port, token, **headers))
        return clients[-1]

    yield connect
    for connected in clients:
        connected.close()
