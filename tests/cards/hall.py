"""A hall around a Raspberry Pi in QEMU: masters, the Arduino at its USB, light that falls on it, and updates."""

import contextlib
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from cards import archive
from cards.files import STATE
from cards.follow import PORT
from tests.integration.discovery.master import LanMaster
from tests.support.avr import AVR_ROBOT, FIRMWARE, build
from tests.support.lan import Lan, Machine
from tests.support.polling import until
from tests.support.programs import ROOT, Program
from tests.support.raspberry_pi import Cable, RaspberryPi

SERIAL_PORT, LIGHT_PORT = 8082, 8083  # where the Pi's cable is
FLASHES = f"""
from socket import create_server
from time import sleep

robot, _ = create_server(("127.0.0.1", {LIGHT_PORT})).accept()
while True:
    for light in (1, 0):
        robot.sendall(f"light {{light}}\\n".encode())
        sleep(1)
"""


class Hall:
    """A network in which nobody gives addresses, with two machines for masters, and a cable for the Pi."""

    def __init__(self, lan: Lan, folder: Path) -> None:
        build()
        self._folder = folder
        self._masters = [lan.machine(), lan.machine()]
        for number, machine in enumerate(self._masters):
            use_link_local_address(machine, number)
        self._beside = lan.machine()
        self.cable = Cable(self._beside)

    def master(self, number: int) -> LanMaster:
        """Both are of the same arena: the one takes the other's place. `number`: 0 or 1."""
        return LanMaster(self._masters[number], "hall", self._folder / f"master{number}")

    @contextlib.contextmanager
    def uno(self) -> Iterator[Program]:
        """An Arduino that is plugged in."""
        ports = ("--tcp", str(SERIAL_PORT), "--arena", f"127.0.0.1:{LIGHT_PORT}")
        uno = self._beside.program(AVR_ROBOT, "--firmware", FIRMWARE, "--name", "virtual0", *ports, "--trace")
        try:
            uno.wait_for("UART at")
            yield uno
        finally:
            uno.kill()

    def drives(self, master: LanMaster, uno: Program) -> None:
        """Wait until the robot is that master's, and its wheels turn as they are told."""
        master.has_robot(1800)
        left, right = position(uno, "left"), position(uno, "right")
        driver = self._peer(master, "publish", "/Robot0/command", "0.025", "100000", "1", "0", "0")
        try:
            until(lambda: position(uno, "left") < left - 100 and position(uno, "right") > right + 100, 600, "it drives")
        finally:
            driver.kill()

    def is_hit(self, master: LanMaster) -> None:
        """Wait until light that falls on it is told to that master."""
        listener = self._peer(master, "listen", "/Robot0/response")
        lamp = self._beside.program(sys.executable, "-c", FLASHES)
        try:
            until(lambda: "message from" in listener.output, 300, "it is hit")
        finally:
            listener.kill()
            lamp.kill()

    @contextlib.contextmanager
    def update(self, version: str) -> Iterator[None]:
        """The first master gives that version to robots, as a master that runs from a card does."""
        served = self._folder / f"served-{version}"
        served.mkdir()
        subprocess.run(["tar", "-xf", another_version(version, self._folder), "-C", served], check=True)
        server = self._masters[0].program(sys.executable, "-m", "http.server", str(PORT), "--directory", served)
        try:
            yield
        finally:
            server.kill()

    def _peer(self, master: LanMaster, *words: str) -> Program:
        own = address(self._masters.index(master.machine))
        ros = {"ROS_MASTER_URI": f"http://{own}:11311", "ROS_IP": own}
        return master.machine.python("tests.integration.robot.peers", *words, env=ros)


def another_version(version: str, folder: Path, **changes: object) -> Path:
    """An update file: the images that the cards hold, and their containers with these changes."""
    new, update = folder / version, folder / f"{version}.update"
    shutil.copytree(ROOT / "build/cards/update", new)
    for description in new.glob("*/containers/*.json"):
        container = {**json.loads(description.read_text()), **changes}
        container["Env"].append(f"UPDATE={version}")
        description.write_text(json.dumps(container))
    archive.write(version, new, update)
    return update


def use_link_local_address(machine: Machine, number: int) -> None:
    """As hosts do in a network in which nobody gives any."""
    machine.ip("addr", "flush", "dev", "eth0", "scope", "global")
    machine.ip("addr", "add", f"{address(number)}/16", "dev", "eth0")


def address(number: int) -> str:
    """Of the machine with that number, such as hosts give themselves."""
    return f"169.254.9.{number + 1}"


def given_version(pi: RaspberryPi) -> str:
    """The newest that has run on the card; "" while none was tried but the one that it was made with."""
    found = pi.run(f"cat {STATE}/state.json 2>/dev/null || echo {{}}")
    return str(json.loads(found).get("current", ""))


def environment(pi: RaspberryPi, container: str) -> str:
    """A line for each of the container's variables."""
    return pi.run(f"sudo docker inspect --format '{{{{range .Config.Env}}}}{{{{println .}}}}{{{{end}}}}' {container}")


def wait_for_the_containers(pi: RaspberryPi) -> None:
    """Until the card's program has started them. The error says what the engine logged."""
    try:
        until(lambda: pi.run("systemctl is-active laserbot-containers || true") == "active\n", 1800)
    except AssertionError as error:
        logged = "sudo journalctl --no-pager --lines 40 --unit docker --unit laserbot-containers"
        error.add_note(pi.run(f"systemctl --failed --no-legend; {logged}"))
        raise


def position(uno: Program, wheel: str) -> int:
    """The wheel's, in half-steps, as the coils have moved it."""
    found = re.findall(rf"coil {wheel} (-?\d+)\n", uno.output)
    return int(found[-1]) if found else 0
