"""The cards: what is on them, and that they start on a Raspberry Pi as what their laserbot.txt says, even if their
power is cut."""

import json
import re
import shutil
from pathlib import Path

import pytest
import yaml

from cards.archive import MANIFEST
from cards.follow import PORT
from cards.laserbot_txt import render
from laser_bot_battle.names import VERSION
from tests.cards.hall import (
    SERIAL_PORT,
    Hall,
    another_version,
    given_version,
    position,
    use_link_local_address,
)
from tests.integration.discovery.robot import LanRobot
from tests.support.avr import build
from tests.support.lan import Lan, needs_root
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.raspberry_pi import (
    FIRST_PARTITION,
    STAND_IN,
    Cable,
    RaspberryPi,
    arduino,
    card_file,
    first_partition,
    partitions,
    put_card_file,
    system_file,
    system_folder,
)

# a Raspberry Pi in an emulator takes minutes to start
pytestmark = [pytest.mark.slow, pytest.mark.timeout(7200)]

MINUTE = 60 * 10**9  # ns, the engine's unit
# In an emulator, a container's own check takes longer than the time until the next one.
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
WHY = "systemctl --failed --no-legend; sudo journalctl --no-pager --lines 40 --unit docker --unit laserbot-containers"
MASTER = yaml.safe_load((ROOT / "ansible/roles/master/vars/main.yml").read_text())["master_services"]
TOKEN, PASSWORD = "correct horse battery staple", "a secret of the hall"
SIGN_IN = f"""python3 -c '
from urllib.request import *
form = b"token={TOKEN}"
print(urlopen("http://localhost/operator/login", form).url)
'"""
GIVEN_TO_ROBOTS = f"""python3 -c '
from urllib.request import urlopen
print(urlopen("http://localhost:{PORT}/{MANIFEST}").read().decode())
'"""


def environment(pi: RaspberryPi, container: str) -> str:
    """A line for each of the container's variables."""
    return pi.run(f"sudo docker inspect --format '{{{{range .Config.Env}}}}{{{{println .}}}}{{{{end}}}}' {container}")


def wait_for_the_containers(pi: RaspberryPi) -> None:
    try:
        until(lambda: pi.run("systemctl is-active laserbot-containers || true") == "active\n", 1800)
    except AssertionError as error:
        error.add_note(pi.run(WHY))
        raise


def wait_for_the_robot(pi: RaspberryPi) -> None:
    """Until its program looks for an arena. The container's health check has too little time in an emulator."""
    wait_for_the_containers(pi)
    until(lambda: "no arena announces itself" in pi.run("sudo journalctl --boot -t laserbot-robot"), 300)


def of(image: Path, folder: Path, *settings: str) -> Path:
    """A card of one's own with these lines in its laserbot.txt."""
    card = folder / "card.img"
    shutil.copy(image, card)
    write_settings(card, *settings)
    return card


def write_settings(card: Path, *settings: str) -> None:
    put_card_file(card, "laserbot.txt", "\r\n".join([*settings, ""]).encode())


def test_a_robots_card_has_all_that_it_needs(robot_image: Path) -> None:
    holds(robot_image, "robot", "rosberry", ["camera", "robot"])


def test_a_masters_card_has_all_that_it_needs(master_image: Path) -> None:
    holds(master_image, "master", "webserver", [service["name"].removeprefix("laserbot-") for service in MASTER])


def holds(card: Path, role: str, image: str, containers: list[str]) -> None:
    first, second = partitions(card)
    assert (first["start"], first["type"], second["type"]) == (FIRST_PARTITION // 512, "c", "83")
    assert card_file(card, "laserbot.txt").decode() == render(role)
    assert system_file(card, "opt/laserbot-card/role") == f"{role}\n"
    assert system_file(card, "opt/laserbot-card/version").startswith(VERSION)
    folder = "opt/laserbot-card/containers"
    assert set(system_folder(card, folder)) == {f"{name}.json" for name in containers}
    for name in containers:
        container = json.loads(system_file(card, f"{folder}/{name}.json"))
        # of this build, and no other of the same version
        assert re.fullmatch(rf"{image}:{re.escape(VERSION)}-sha256-[0-9a-f]{{64}}", container["Image"])
        assert container["HostConfig"]["RestartPolicy"]["Name"] == "unless-stopped"


def test_a_card_starts_as_what_its_file_says_and_comes_back_after_cuts(
    robot_image: Path, key: Path, tmp_path: Path
) -> None:
    public = key.with_suffix(".pub").read_text().strip()
    settings = ("name = raspberrypi7", "time zone = Europe/Berlin", "role = both", f"ssh key = {public}")
    card = of(robot_image, tmp_path, *settings)
    pi = RaspberryPi(tmp_path, card, key)
    with pi.on():
        assert pi.run("hostname; date +%Z").split()[0] == "raspberrypi7"
        assert pi.run("readlink /etc/localtime") == "/usr/share/zoneinfo/Europe/Berlin\n"
        told = pi.run("sudo cat /boot/firmware/laserbot-errors.txt")
        assert told == "laserbot.txt, line 3: role = both: must be robot or master\n"
        wait_for_the_robot(pi)
        assert "LASERBOT_ROBOT_NAME=raspberrypi7\n" in environment(pi, "laserbot-robot")
        assert pi.run("systemctl --failed --plain --no-legend") == ""
        # the state has the rest of the card
        size = int(pi.run("df --output=size --block-size=1M /var/lib/docker | tail -n 1"))
        assert size > 3000
        first_start = pi.run("cat /etc/machine-id; sudo cat /etc/ssh/ssh_host_ed25519_key.pub")
        pi.run("echo kept | sudo tee /etc/kept && sync")
    wifi = ("country = DE", "wifi = hall", f"wifi_password = {PASSWORD}")
    write_settings(card, "name = raspberrypi7", f"ssh_key = {public}", *wifi, "secrets = move")
    assert PASSWORD.encode() in first_partition(card)
    with pi.on():
        assert f'psk="{PASSWORD}"' in pi.run("sudo cat /etc/wpa_supplicant/wpa_supplicant-wlan0.conf")
        assert pi.run("cat /etc/machine-id; sudo cat /etc/ssh/ssh_host_ed25519_key.pub") == first_start
        assert pi.run("cat /etc/kept") == "kept\n"
        assert "card: making" not in pi.screen()
        wait_for_the_robot(pi)
        # as a cut leaves it while an image is loaded
        pi.run("sudo touch /var/lib/laserbot-card/engine-unsound && sync")
    assert b"# wifi_password: moved\r\n" in card_file(card, "laserbot.txt")
    assert PASSWORD.encode() not in first_partition(card)
    with pi.on():
        wait_for_the_robot(pi)
        assert "card: making the engine's files anew" in pi.screen()
        assert pi.run("cat /etc/kept; ls /var/lib/laserbot-card/engine-unsound 2>/dev/null || true") == "kept\n"
        # what is beyond repair is made anew
        pi.run("sudo dd if=/dev/zero of=/dev/mmcblk0p3 bs=1M count=64 conv=fsync 2>/dev/null")
    with pi.on():
        assert pi.run("hostname; ls /etc/kept 2>/dev/null || true") == "raspberrypi7\n"
        assert "card: making /dev/mmcblk0p3" in pi.screen()
        wait_for_the_robot(pi)


@needs_root
def test_a_masters_card_serves_the_game_and_announces_it(master_image: Path, key: Path, tmp_path: Path) -> None:
    """Virtual robots find it in its network, and a player drives one of them. The master takes an update."""
    public = key.with_suffix(".pub").read_text().strip()
    settings = ("arena = hall", f"operator_token = {TOKEN}", f"ssh_key = {public}", "name = raspberrypi7")
    with Lan() as lan:
        cable = Cable(lan.machine())
        card = of(master_image, tmp_path, *settings)
        pi = RaspberryPi(tmp_path, card, key, cable, board=STAND_IN)
        with pi.on():
            serves(pi)
            drives_robots_beside_it(lan, tmp_path)
            time = int(pi.run("sudo systemctl start laserbot-clock && sync && date +%s"))
        update = another_version("9.9.9", tmp_path, Healthcheck=LIGHT_HEALTH_CHECK)
        put_card_file(card, "new.update", update.read_bytes())
        with pi.on():
            assert int(pi.run("date +%s")) > time, "its clock goes on from there"
            runs_the_update(pi)


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


def serves(pi: RaspberryPi) -> None:
    """Wait until a master's card does all that it can do alone."""
    assert pi.run("hostname") == "laser-bot-master\n"
    told = pi.run("sudo cat /boot/firmware/laserbot-errors.txt")
    assert told == "laserbot.txt, line 4: name = raspberrypi7: is for a robot's card only\n"
    pi.run(LIGHTEN_HEALTH_CHECKS)
    wait_for_the_containers(pi)
    running = pi.run("sudo docker ps --format '{{.Names}}'").split()
    assert sorted(running) == sorted(service["name"] for service in MASTER)
    announced = "sudo journalctl --boot -t laserbot-announcer"
    until(lambda: "arena 'hall' is announced" in pi.run(announced), 1800, "it announces itself")
    signed_in = "http://localhost/operator\n"
    until(lambda: pi.run(f"{SIGN_IN} 2>/dev/null || true") == signed_in, 1800, "the operator can sign in")


def runs_the_update(pi: RaspberryPi) -> None:
    """Wait until a master has taken the file from its card, runs what is in it, and gives it to robots."""
    until(lambda: given_version(pi) == "9.9.9", 3000, "it runs the update")
    assert "new.update" not in pi.run("sudo ls /boot/firmware").split()
    assert "UPDATE=9.9.9\n" in environment(pi, "laserbot-web")
    until(lambda: '"version": "9.9.9"' in pi.run(f"{GIVEN_TO_ROBOTS} 2>/dev/null || true"), 600, "robots are given it")


@needs_root
def test_a_robots_card_plays_with_the_firmware_and_a_master(robot_image: Path, key: Path, tmp_path: Path) -> None:
    """A whole Raspberry Pi, the Arduino's real firmware at its USB, in a network in which nobody gives addresses.

    It plays on after a power cut with another Arduino, of another version, and with another master.
    """
    with Lan() as lan:
        hall = Hall(lan, tmp_path)
        card = of(robot_image, tmp_path, f"ssh_key = {key.with_suffix('.pub').read_text().strip()}")
        pi = RaspberryPi(tmp_path, card, key, hall.cable, usb=arduino(SERIAL_PORT))
        with hall.master(0) as master:
            with hall.uno() as uno, pi.on():
                wait_for_the_containers(pi)
                hall.drives(master, uno)
                hall.is_hit(master)
            with hall.uno() as another, pi.on():
                hall.drives(master, another)
                with hall.update("9.9.9"):
                    until(lambda: given_version(pi) == "9.9.9", 3000, "it runs the update")
                assert "UPDATE=9.9.9\n" in environment(pi, "laserbot-robot")
                hall.drives(master, another)
                master.kill()
                with hall.master(1) as other:
                    hall.drives(other, another)


@needs_root
def test_an_arduino_is_pulled_from_a_running_robot_and_put_back(robot_image: Path, key: Path, tmp_path: Path) -> None:
    """Not on the emulated Pi, whose USB controller crashes QEMU when a device in use is unplugged."""
    with Lan() as lan:
        hall = Hall(lan, tmp_path)
        card = of(robot_image, tmp_path)
        pi = RaspberryPi(tmp_path, card, key, hall.cable, usb=arduino(SERIAL_PORT), board=STAND_IN)
        with hall.master(0) as master, pi.on():
            for _ in range(3):
                with hall.uno() as uno:
                    hall.drives(master, uno)
