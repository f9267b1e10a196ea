"""The robot's programs with the real firmware in the simulator: the two sides of the protocol meet."""

import re
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program
from tests.support.ros import RosMaster

Simulated = Callable[..., Program]


@pytest.fixture
def simulated() -> Iterator[Simulated]:
    """Starts the simulated Uno with the firmware; its coils are told on its output."""
    programs = []

    def begin(*uart: str) -> Program:
        binary, firmware = ROOT / "build/sim/avr_robot", ROOT / "build/firmware/laserbot.elf"
        words = [str(binary), "--firmware", str(firmware), "--name", "virtual0", *uart, "--trace"]
        programs.append(Program(words))
        programs[-1].wait_for("ready")
        return programs[-1]

    yield begin
    for program in programs:
        program.kill()


def steps(uno: Program, wheel: str) -> int:
    """The wheel's position in half-steps, as the coils have moved it."""
    positions = re.findall(rf"coil {wheel} (-?\d+)\n", uno.output)
    return int(positions[-1]) if positions else 0


def drive(uno: Program, device: str, master: RosMaster) -> None:
    """One command forward through ROS and the serial node, up to the coils."""
    node = Program.python("robot.serial_node", device, "__name:=Robot0", "command:=/Robot0/command", env=master.env)
    peer = None
    try:
        node.wait_for("/Robot0/command")
        arguments = ("publish", "/Robot0/command", "0.025", "10", "1", "0", "0")
        peer = Program.python("tests.integration.robot.peers", *arguments, env=master.env)
        until(lambda: steps(uno, "left") < -100 and steps(uno, "right") > 100)
        assert node.stop(signal.SIGINT) == 0
    finally:
        node.kill()
        if peer is not None:
            peer.kill()


def test_a_command_turns_the_coils_over_a_serial_device(
    simulated: Simulated, ros_master: RosMaster, tmp_path: Path
) -> None:
    device = str(tmp_path / "ttyACM0")
    drive(simulated("--serial", device), device, ros_master)


def test_a_command_turns_the_coils_over_tcp(simulated: Simulated, ros_master: RosMaster) -> None:
    port = free_port()
    drive(simulated("--tcp", f"127.0.0.1:{port}"), f"socket://127.0.0.1:{port}", ros_master)
