"""The profiles master and robot of compose.yaml on one host: a robot with an Arduino on a serial device joins."""

import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
import requests

from tests.support import avr
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        os.environ.get("IMAGES_ENGINE") == "running",
        reason="these services use the host's network: a private engine's only",
    ),
]

AVAHI = Path("/run/avahi-daemon")


@pytest.fixture
def serial_device(tmp_path: Path) -> Iterator[str]:
    """A virtual Arduino's device, which the group of serial devices may open (as udev would have it)."""
    avr.build()
    link = tmp_path / "arduino"
    words = ["--firmware", str(avr.FIRMWARE), "--name", "virtual1", "--serial", str(link)]
    program = Program([str(avr.AVR_ROBOT), *words])
    try:
        program.wait_for("UART at")
        device = os.readlink(link)
        os.chown(device, -1, 20)  # dialout, in every Debian
        os.chmod(device, 0o660)
        yield device
    finally:
        program.stop()


def test_a_robot_on_a_serial_device_joins_the_master(version: str, serial_device: str) -> None:
    had_avahi = AVAHI.exists()
    web_port = free_port()
    environment = {
        **os.environ,
        "LASERBOT_VERSION": version,
        "LASERBOT_WEB_PORT": str(web_port),
        "LASERBOT_ROSBRIDGE_PORT": str(free_port()),
        "LASERBOT_ROSTER": "raspberrypi5=5",
        "LASERBOT_MASTER": "127.0.0.1",
        "LASERBOT_ROBOT_NAME": "raspberrypi5",
        "LASERBOT_SERIAL": f"/host/dev/ttyACM0 /host{serial_device}",
        "ROS_IP": "127.0.0.1",
    }

    def compose(*words: str) -> str:
        command = ["docker", "compose", "--env-file=/dev/null", f"--project-directory={ROOT}"]
        command += [f"--project-name=laserbot-lan-{os.getpid()}", "--profile=master", "--profile=robot", *words]
        result = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert result.returncode == 0, f"{' '.join(command)}: {result.stdout}{result.stderr}"
        return result.stdout

    def healthy() -> bool:
        rows = [json.loads(line) for line in compose("ps", "--all", "--format", "json").splitlines()]
        return {row["Service"]: row["Health"] for row in rows} == dict.fromkeys(
            ("ros-master", "rosbridge", "web", "robot"), "healthy"
        )

    try:
        compose("up", "--detach", "--pull=never")
        try:
            until(healthy, 90, "all four services are healthy")
        except AssertionError as error:
            raise AssertionError(f"{error}\n{compose('logs')}") from None
        reply = requests.post(f"http://127.0.0.1:{web_port}/signUpUser", data={"data": "Ann"}, timeout=5)
        assert json.loads(reply.text)["robot"] == 5
    finally:
        compose("down", "--volumes", "--timeout", "5")
        if not had_avahi:  # the engine has made the empty folder
            AVAHI.rmdir()
