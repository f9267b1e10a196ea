"""What a master's card has to do, as far as a Raspberry Pi in QEMU lets it."""

import json
import re
from pathlib import Path

import yaml

from cards.archive import MANIFEST
from cards.follow import PORT
from tests.cards.hall import (
    environment,
    given_version,
    position,
    use_link_local_address,
    wait_for_the_containers,
)
from tests.integration.discovery.robot import LanRobot
from tests.support.avr import build
from tests.support.lan import Lan
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.raspberry_pi import RaspberryPi

MINUTE = 60 * 10**9  # ns, the engine's unit
# In an emulator, a container's own check takes longer than the interval between two.
LIGHT_HEALTH_CHECK = {
    "Test": ["CMD", "true"],
    "StartPeriod": 60 * MINUTE,
    "StartInterval": MINUTE,  # until it has passed once
    "Interval": 60 * MINUTE,
    "Timeout": MINUTE,
}
LIGHTEN_HEALTH_CHECKS = f"""sudo python3 -c '
from json import dumps, loads
from pathlib import Path
for path in Path("/opt/laserbot-card/containers").iterdir():
    path.write_text(dumps({{**loads(path.read_text()), "Healthcheck": {json.dumps(LIGHT_HEALTH_CHECK)}}}))
'
sudo systemctl restart --no-block laserbot-containers
"""
_VARS = yaml.safe_load((ROOT / "ansible/roles/master/vars/main.yml").read_text())
CONTAINERS = sorted(service["name"] for service in _VARS["master_services"])
TOKEN = "correct horse battery staple"
# the lines of its laserbot.txt after the SSH key; the last is a mistake, which must not keep it from starting
SETTINGS = ("arena = hall", f"operator_token = {TOKEN}", "name = raspberrypi7")
SIGN_IN = f"""python3 -c '
from urllib.request import *
form = b"token={TOKEN}"
print(urlopen("http://localhost/operator/login", form).url)
'"""


def serves(pi: RaspberryPi) -> None:
    """Wait until it does all that it can do alone."""
    assert pi.run("hostname") == "laser-bot-master\n"
    pi.run(LIGHTEN_HEALTH_CHECKS)
    wait_for_the_containers(pi)
    told = pi.run("sudo cat /boot/firmware/laserbot-errors.txt")
    assert told == f"laserbot.txt, line {len(SETTINGS) + 1}: name = raspberrypi7: is for a robot's card only\n"
    running = pi.run("sudo docker ps --format '{{.Names}}'").split()
    assert sorted(running) == CONTAINERS
    announced = "sudo journalctl --boot -t laserbot-announcer"
    until(lambda: "arena 'hall' is announced" in pi.run(announced), 1800, "it announces itself")
    signed_in = "http://localhost/operator\n"
    until(lambda: pi.run(f"{SIGN_IN} 2>/dev/null || true") == signed_in, 1800, "the operator can sign in")


def drives_robots_beside_it(lan: Lan, folder: Path) -> None:
    """Wait until virtual robots have found the arena, and one of them turns as a player says."""
    build()
    *beside, players = (lan.machine() for _ in range(3))
    for number, machine in enumerate([*beside, players]):
        use_link_local_address(machine, number)
    first, second = (LanRobot(machine, folder, LASERBOT_ROBOT_NAME=f"beside-{machine.pid}") for machine in beside)
    with first, second:
        for robot in first, second:
            robot.wait_for("/command", 600)
        (found,) = set(re.findall(r"arena 'hall' at ([0-9.]+), announced", first.output + second.output))
        guest = players.python("tests.cards.guest", found)
        try:
            guest.wait_for("turns robot", 600)
            until(lambda: any(abs(position(robot.uno, "left")) > 100 for robot in (first, second)), 300, "one turns")
        finally:
            guest.kill()


def runs_the_update(pi: RaspberryPi, version: str) -> None:
    """Wait until it has taken the file new.update from its card, runs what is in it, and gives that to robots."""
    until(lambda: given_version(pi) == version, 3000, "it runs the update")
    wait_for_the_containers(pi)  # of this start: it may have run the update in an earlier one
    assert "new.update" not in pi.run("sudo ls /boot/firmware").split()
    assert f"UPDATE={version}\n" in environment(pi, "laserbot-web")
    tells_robots(pi, version)
    assert f"UPDATE={version}" in pi.run(given("robot/containers/robot.json"))


def tells_robots(pi: RaspberryPi, version: str) -> None:
    """Wait until it tells robots that it runs that version."""
    told = f'"version": "{version}"'
    until(lambda: told in pi.run(f"{given(MANIFEST)} 2>/dev/null || true"), 600, told)


def given(file: str) -> str:
    """The command that prints that file as robots are given it."""
    url = f"http://localhost:{PORT}/{file}"
    return f"python3 -c 'from urllib.request import urlopen; print(urlopen(\"{url}\").read().decode())'"
