"""Every program of every image starts for its platform, as hardened as it is meant to run."""

import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from tests.support.containers import Container

MASTER_PLATFORMS = ["linux/amd64", "linux/arm64"]
ROBOT_PLATFORMS = ["linux/arm/v7", "linux/arm64", "linux/amd64"]
ROS = {"ROS_MASTER_URI": "http://master:11311", "LASERBOT_MASTER": "web"}

AVR_ROBOT = ["avr_robot", "--firmware", "/opt/laserbot/firmware/laserbot.elf", "--name", "virtual0"]
AVR_ROBOT += ["--tcp", "0.0.0.0:8082", "--arena", "arena:8081"]


class Battle:
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
        master = self.start("webserver", platform, "master", "rosmaster", "--core", "-p", "11311")
        web = self.start("webserver", platform, "web")
        bridge = self.start("webserver", platform, "rosbridge", "python3", "-m", "server.rosbridge")
        return [master, web, bridge]


@pytest.fixture
def battle(version: str, network: str) -> Iterator[Battle]:
    with ExitStack() as stack:
        yield Battle(stack, version, network)


@pytest.mark.parametrize("platform", MASTER_PLATFORMS)
def test_the_masters_three_services_become_healthy_and_end_quickly(battle: Battle, platform: str) -> None:
    containers = battle.start_master(platform)
    for container in containers:
        container.wait_until_healthy()
    for container in containers:
        assert container.run("id", "-u").strip() == "10001"
        began = time.monotonic()
        container.stop()
        took = time.monotonic() - began
        assert container.state["ExitCode"] in {0, 130}, container.logs
        # an emulated program takes longer for everything
        assert took < (2.0 if platform == "linux/amd64" else 10.0)


@pytest.mark.parametrize("platform", ROBOT_PLATFORMS)
def test_a_robot_with_its_firmware_joins_the_battle(battle: Battle, platform: str) -> None:
    battle.start_master("linux/amd64")
    battle.start("sim", "linux/amd64", "arena")
    uart = battle.start("sim", "linux/amd64", "uart", *AVR_ROBOT)
    robot = battle.start(
        "rosberry", platform, "robot", LASERBOT_SERIAL="socket://uart:8082", LASERBOT_ROBOT_NAME="virtual0"
    )
    uart.wait_until_healthy()
    robot.wait_until_healthy(240)
    assert robot.run("ls", "/opt/laserbot/firmware").split() == ["laserbot.hex"]
    assert "Usage" in robot.run("sh", "-c", "avrdude 2>&1")


@pytest.mark.parametrize("platform", ROBOT_PLATFORMS)
def test_the_arena_and_a_virtual_robot_become_healthy(battle: Battle, platform: str) -> None:
    arena = battle.start("sim", platform, "arena")
    uart = battle.start("sim", platform, "uart", *AVR_ROBOT)
    arena.wait_until_healthy()
    uart.wait_until_healthy()
    assert "usage" in arena.run("python3", "-m", "sim.bot", "--help")
