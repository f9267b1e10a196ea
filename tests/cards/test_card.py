"""The cards: what is on them, and that they start on a Raspberry Pi as what their laserbot.txt says, even if their
power is cut."""

import json
import re
from pathlib import Path

import pytest

from cards.files import CONTAINER_USER
from cards.laserbot_txt import render
from laser_bot_battle.names import VERSION
from tests.cards import master_card
from tests.cards.hall import (
    SERIAL_PORT,
    Hall,
    another_version,
    environment,
    given_version,
    wait_for_the_containers,
)
from tests.support.lan import Lan, needs_root
from tests.support.polling import until
from tests.support.raspberry_pi import (
    FIRST_PARTITION,
    STAND_IN,
    Cable,
    RaspberryPi,
    arduino,
    card_file,
    first_partition,
    new_card,
    partitions,
    put_card_file,
    system_file,
    system_folder,
    write_settings,
)

# a Raspberry Pi in an emulator takes minutes to start
pytestmark = [pytest.mark.slow, pytest.mark.timeout(7200)]

PASSWORD = "a secret of the hall"
ROBOTS = """sudo python3 -c '
import sqlite3
game = sqlite3.connect("file:/var/lib/laserbot/laserbot.db?mode=ro", uri=True)
print(game.execute("SELECT caller, robot FROM robots ORDER BY caller").fetchall())
'"""


def wait_for_the_robot(pi: RaspberryPi) -> None:
    """Until its program looks for an arena. The container's health check has too little time in an emulator."""
    wait_for_the_containers(pi)
    until(lambda: "no arena announces itself" in pi.run("sudo journalctl --boot -t laserbot-robot"), 300)


def destroy(pi: RaspberryPi, partition: str) -> None:
    """Overwrite its beginning, with the first spare superblock, so that nothing can mend it."""
    pi.run(f"sudo dd if=/dev/zero of={partition} bs=1M count=160 conv=fsync 2>/dev/null")


def test_a_robots_card_has_all_that_it_needs(robot_image: Path) -> None:
    holds(robot_image, "robot", "rosberry", ["camera", "robot"])


def test_a_masters_card_has_all_that_it_needs(master_image: Path) -> None:
    containers = [name.removeprefix("laserbot-") for name in master_card.CONTAINERS]
    holds(master_image, "master", "webserver", containers)


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
    card = new_card(robot_image, tmp_path, *settings)
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
        destroy(pi, "/dev/mmcblk0p3")
    with pi.on():
        assert pi.run("hostname; ls /etc/kept 2>/dev/null || true") == "raspberrypi7\n"
        assert "card: making /dev/mmcblk0p3" in pi.screen()
        wait_for_the_robot(pi)


@needs_root
def test_a_masters_card_serves_the_game_and_announces_it(master_image: Path, key: Path, tmp_path: Path) -> None:
    """Virtual robots find it in its network, and a player drives one of them.

    The master takes an update, and goes back to the version before. When its third partition is destroyed, it gets
    what it knew of its robots from the copy on the first.
    """
    settings = (f"ssh_key = {key.with_suffix('.pub').read_text().strip()}", *master_card.SETTINGS)
    with Lan() as lan:
        cable = Cable(lan.machine())
        card = new_card(master_image, tmp_path, *settings)
        pi = RaspberryPi(tmp_path, card, key, cable, board=STAND_IN)
        with pi.on():
            master_card.serves(pi)
            master_card.drives_robots_beside_it(lan, tmp_path)
            time = int(pi.run("sudo systemctl start laserbot-clock && sync && date +%s"))
        update = another_version("9.9.9", tmp_path, Healthcheck=master_card.LIGHT_HEALTH_CHECK)
        put_card_file(card, "new.update", update.read_bytes())
        with pi.on():
            assert int(pi.run("date +%s")) > time, "its clock goes on from there"
            master_card.runs_the_update(pi, "9.9.9")
            pi.run("sync")
        write_settings(card, *settings, "version = previous")
        with pi.on():
            assert given_version(pi) == "9.9.9"
            wait_for_the_containers(pi)
            assert "UPDATE=" not in environment(pi, "laserbot-web")
            master_card.tells_robots(pi, pi.run("cat /opt/laserbot-card/version").strip())
            robots = pi.run(ROBOTS)
            assert robots.count("beside") == 2
            pi.run("sudo systemctl start laserbot-backups")
            destroy(pi, "/dev/vda3")
        with pi.on():
            assert pi.run("hostname") == "laser-bot-master\n"
            assert "card: making /dev/vda3" in pi.screen()
            master_card.serves(pi)
            assert pi.run(ROBOTS) == robots
            assert pi.run("sudo stat --format %u /var/lib/laserbot/laserbot.db") == f"{CONTAINER_USER}\n"


@needs_root
def test_a_robots_card_plays_with_the_firmware_and_a_master(robot_image: Path, key: Path, tmp_path: Path) -> None:
    """A whole Raspberry Pi, the Arduino's real firmware at its USB, in a network in which nobody gives addresses.

    It plays on after a power cut with another Arduino, of another version, and with another master.
    """
    with Lan() as lan:
        hall = Hall(lan, tmp_path)
        card = new_card(robot_image, tmp_path, f"ssh_key = {key.with_suffix('.pub').read_text().strip()}")
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
        card = new_card(robot_image, tmp_path)
        pi = RaspberryPi(tmp_path, card, key, hall.cable, usb=arduino(SERIAL_PORT), board=STAND_IN)
        with hall.master(0) as master, pi.on():
            for _ in range(3):
                with hall.uno() as uno:
                    hall.drives(master, uno)
