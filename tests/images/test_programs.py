"""Every program of every image starts for its platform, as hardened as it is meant to run."""

from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from tests.support.containers import Container
from tests.support.documents import kubernetes_pages
from tests.support.polling import until

MASTER_PLATFORMS = ["linux/amd64", "linux/arm64"]
ROBOT_PLATFORMS = ["linux/arm/v7", "linux/arm64", "linux/amd64"]
ROS = {"ROS_MASTER_URI": "http://master:11311", "LASERBOT_MASTER": "web"}

AVR_ROBOT = ["avr_robot", "--firmware", "/opt/laserbot/firmware/laserbot.elf", "--name", "virtual0"]
AVR_ROBOT += ["--tcp", "0.0.0.0:8082", "--arena", "arena:8081"]
POSITIONS = ["python3", "-m", "sim.positions", "--arena", "arena:8080"]


class Programs:
    """The containers of one test by their names in the network."""

    def __init__(self, stack: ExitStack, version: str, network: str) -> None:
        self._stack, self._version, self._network = stack, version, network

    def start(self, image: str, platform: str, name: str, *command: str, **env: str) -> Container:
        container = Container(
            f"{image}:{self._version}", platform, *command, network=self._network, name=name,
            env={**ROS, "ROS_HOSTNAME": name, **env},
        )  # fmt: skip
        return self._stack.enter_context(container)

    def start_master(self, platform: str) -> list[Container]:
        master = self.start("webserver", platform, "master", "python3", "-m", "server.ros.master", "-p", "11311")
        web = self.start("webserver", platform, "web", LASERBOT_DATA="/run/laserbot")
        bridge = self.start("webserver", platform, "rosbridge", "python3", "-m", "server.rosbridge")
        relay = self.start("webserver", platform, "relay", "python3", "-m", "server.camera")
        announcer = self.start("webserver", platform, "announcer", "python3", "-m", "server.announcer")
        rosout = self.start("webserver", platform, "rosout", "python3", "-m", "server.ros.rosout")
        bots = self.start(
            "webserver", platform, "bots", "python3", "-m", "server.bots", "--rosbridge", "rosbridge:9090"
        )
        return [master, web, bridge, relay, announcer, rosout, bots]


@pytest.fixture
def programs(version: str, network: str) -> Iterator[Programs]:
    with ExitStack() as stack:
        yield Programs(stack, version, network)


def check_end(container: Container) -> None:
    """It runs as nobody special and ends when told."""
    assert container.run("id", "-u").strip() == "10001"
    container.stop()


@pytest.mark.slow
@pytest.mark.parametrize("platform", MASTER_PLATFORMS)
def test_the_masters_services_become_healthy_and_end_quickly(
    programs: Programs, platform: str, figures: list[str]
) -> None:
    containers = programs.start_master(platform)
    took = [container.wait_until_healthy() for container in containers]
    figures.append(f"webserver {platform}: the master's services healthy after {max(took):.1f} s")
    for container in reversed(containers):
        check_end(container)


def test_a_ros_master_whose_port_another_one_has_ends_and_says_so(version: str) -> None:
    words = [f"webserver:{version}", "linux/amd64", "python3", "-m", "server.ros.master", "-p", "11311"]
    with Container(*words) as first:
        first.wait_until_healthy()
        with Container(*words, network=f"container:{first.id}") as second:
            told = "cannot serve port 11311"
            until(lambda: told in second.logs, 20, "it finds its port taken")
            assert told in kubernetes_pages()


@pytest.mark.slow
@pytest.mark.parametrize("platform", ROBOT_PLATFORMS)
def test_a_robot_joins_the_battle_with_its_firmware_inside(
    programs: Programs, platform: str, figures: list[str]
) -> None:
    _, web, *_ = programs.start_master("linux/amd64")
    uart = programs.start("sim", "linux/amd64", "uart", *AVR_ROBOT)
    web.wait_until_healthy()
    uart.wait_until_healthy()
    robot = programs.start(
        "rosberry", platform, "robot", LASERBOT_SERIAL="socket://uart:8082", LASERBOT_ROBOT_NAME="virtual0"
    )
    figures.append(f"rosberry {platform}: robot healthy after {robot.wait_until_healthy(240):.1f} s")
    assert robot.run("ls", "/opt/laserbot/firmware").split() == ["laserbot.hex"]
    # the library is there; in this test the GPIO is not, and the robot works without
    assert "no status LED: line 18 of /dev/gpiochip0: " in robot.logs
    assert "Usage" in robot.run("sh", "-c", "avrdude 2>&1")
    check_end(robot)


@pytest.mark.slow
@pytest.mark.parametrize("platform", ROBOT_PLATFORMS)
def test_the_arena_a_virtual_robot_and_who_tells_of_them_become_healthy(
    programs: Programs, platform: str, figures: list[str]
) -> None:
    _, web, *_ = programs.start_master("linux/amd64")
    web.wait_until_healthy()
    arena = programs.start("sim", platform, "arena")
    uart = programs.start("sim", platform, "uart", *AVR_ROBOT)
    positions = programs.start("sim", platform, "positions", *POSITIONS)
    containers = [arena, uart, positions]
    took = [container.wait_until_healthy() for container in containers]
    figures.append(f"sim {platform}: arena, virtual robot, positions healthy after {max(took):.1f} s")
    for container in containers:
        check_end(container)
