"""A robot on a machine of a LAN: the real firmware in the simulator, and the robot's own program, told no address."""

import time
from collections.abc import Callable
from pathlib import Path

from tests.integration.discovery.master import NOTHING_GIVEN
from tests.support.lan import Machine
from tests.support.programs import ROOT


class LanRobot:
    """A context manager that ends it. `variables` are settings."""

    def __init__(self, machine: Machine, folder: Path, **variables: str) -> None:
        device = folder / f"ttyACM-{machine.pid}"
        self.machine = machine
        simulator, firmware = ROOT / "build/sim/avr_robot", ROOT / "build/firmware/laserbot.elf"
        words = ["--firmware", firmware, "--name", "virtual0", "--serial", device, "--trace"]
        self._arduino = map(str, [simulator, *words])
        self._env = {
            **NOTHING_GIVEN,
            "LASERBOT_SERIAL": str(device),
            "LASERBOT_ROBOT_NAME": "lan-robot",
            "LASERBOT_LED": "none",
            "ROS_HOME": str(folder / "ros-robot"),
            "ROS_LOG_DIR": str(folder / "ros-robot" / "log"),
            **variables,
        }

    def __enter__(self) -> "LanRobot":
        self.uno = self.machine.program(*self._arduino)
        self.uno.wait_for("UART at")
        self.program = self.machine.python("robot.id_service_client", env=self._env)
        return self

    def __exit__(self, *_: object) -> None:
        try:
            if self.program.running:
                assert self.program.stop() == 0
            assert "Traceback" not in self.output, self.output
        finally:
            self.program.kill()
            self.uno.kill()

    @property
    def output(self) -> str:
        return self.program.output

    def wait_for(self, text: str, seconds: float = 30) -> str:
        return self.program.wait_for(text, seconds)

    def lives(self) -> int:
        """How often its serial node has started."""
        return self.output.count("/Robot0/command")

    def memory(self) -> int:
        """Its resident memory in MB. nsenter becomes the program itself, which keeps another going."""
        keeper = self.program.process.pid
        (worker,) = Path(f"/proc/{keeper}/task/{keeper}/children").read_text().split()
        status = Path(f"/proc/{worker}/status").read_text()
        return int(status.partition("VmRSS:")[2].split()[0]) // 1024


def stays(condition: Callable[[], bool], seconds: float) -> None:
    """AssertionError unless the condition holds all the time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        assert condition()
        time.sleep(0.05)
