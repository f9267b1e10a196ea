"""What is around a robot: a ROS master, the service that gives IDs, a web server, a device."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.integration.robot.device import Device
from tests.integration.robot.id_service import IdService
from tests.integration.robot.web_server import WebServer
from tests.support.programs import Program
from tests.support.ros import RosMaster, ros_master

__all__ = ["ros_master"]


@pytest.fixture
def ids(ros_master: RosMaster, tmp_path: Path) -> Iterator[IdService]:
    service = IdService(ros_master, tmp_path / "next_id")
    yield service
    service.kill()


@pytest.fixture
def web() -> Iterator[WebServer]:
    with WebServer() as web:
        yield web


@pytest.fixture
def device(tmp_path: Path) -> Iterator[Device]:
    with Device(tmp_path / "ttyACM0") as device:
        yield device


@pytest.fixture
def settings(ros_master: RosMaster, web: WebServer, device: Device, tmp_path: Path) -> dict[str, str]:
    """The robot's environment; it tries again every half second instead of every 5 s."""
    return {
        **ros_master.env,
        "LASERBOT_MASTER": "127.0.0.1",
        "LASERBOT_WEB_PORT": str(web.port),
        "LASERBOT_SERIAL": device.path,
        "LASERBOT_ROBOT_NAME": "test-robot.1",
        "LASERBOT_RETRY": "0.5",
        "LASERBOT_ALIVE_FILE": str(tmp_path / "alive"),
    }


Start = Callable[..., Program]


@pytest.fixture
def start(ros_master: RosMaster) -> Iterator[Start]:
    """Starts a program of this repository in the ROS of the test."""
    with ExitStack() as ends:

        def begin(module: str, *arguments: str) -> Program:
            program = Program.python(module, *arguments, env=ros_master.env)
            ends.callback(program.kill)
            return program

        yield begin


def serve(start: Start, device: str, robot_id: int) -> Program:
    """The serial node of Robot<robot_id>, with the device's topics joined."""
    name = f"Robot{robot_id}"
    node = start(
        "robot.serial_node", device, f"__name:={name}", f"command:={name}/command", f"response:={name}/response"
    )
    node.wait_for(f"/{name}/command")
    return node
