"""The robot's card starts on a Raspberry Pi, and is what its laserbot.txt says, even if its power is cut."""

import shutil
from pathlib import Path

import pytest

from cards.laserbot_txt import render
from tests.support.polling import until
from tests.support.raspberry_pi import FIRST_PARTITION, RaspberryPi, card_file, partitions, put_card_file

# a Raspberry Pi in an emulator takes minutes to start
pytestmark = [pytest.mark.slow, pytest.mark.timeout(7200)]

ENVIRONMENT = "sudo docker inspect --format '{{range .Config.Env}}{{println .}}{{end}}' laserbot-robot"
WHY = "systemctl --failed --no-legend; sudo journalctl --no-pager --lines 40 --unit docker --unit laserbot-robot"


def wait_for_the_robot(pi: RaspberryPi) -> None:
    """Until its program looks for an arena. The container's health check has too little time in an emulator."""
    try:
        until(lambda: pi.run("systemctl is-active laserbot-robot || true") == "active\n", 1800)
        until(lambda: "no arena announces itself" in pi.run("sudo journalctl --boot -t laserbot-robot"), 300)
    except AssertionError as error:
        error.add_note(pi.run(WHY))
        raise


def test_any_computer_reads_the_first_partition(image: Path) -> None:
    first, second = partitions(image)
    assert (first["start"], first["type"], second["type"]) == (FIRST_PARTITION // 512, "c", "83")
    assert card_file(image, "laserbot.txt").decode() == render()


def test_a_card_starts_as_what_its_file_says_and_comes_back_after_cuts(image: Path, key: Path, tmp_path: Path) -> None:
    card = tmp_path / "card.img"
    shutil.copy(image, card)
    public = key.with_suffix(".pub").read_text()
    settings = f"name = raspberrypi7\r\ntime zone = Europe/Berlin\r\nrole = both\r\nssh key = {public}"
    put_card_file(card, "laserbot.txt", settings.encode())
    pi = RaspberryPi(tmp_path, card, key)
    with pi.on():
        assert pi.run("hostname; date +%Z").split()[0] == "raspberrypi7"
        assert pi.run("readlink /etc/localtime") == "/usr/share/zoneinfo/Europe/Berlin\n"
        told = pi.run("sudo cat /boot/firmware/laserbot-errors.txt")
        assert told == "laserbot.txt, line 3: role = both: must be robot or master\r\n"
        wait_for_the_robot(pi)
        assert "LASERBOT_ROBOT_NAME=raspberrypi7\n" in pi.run(ENVIRONMENT)
        assert pi.run("systemctl --failed --plain --no-legend") == ""
        # the state has the rest of the card
        size = int(pi.run("df --output=size --block-size=1M /var/lib/docker | tail -n 1"))
        assert size > 3000
        first_start = pi.run("cat /etc/machine-id; sudo cat /etc/ssh/ssh_host_ed25519_key.pub")
        pi.run("echo kept | sudo tee /etc/kept && sync")
    with pi.on():
        assert pi.run("cat /etc/machine-id; sudo cat /etc/ssh/ssh_host_ed25519_key.pub") == first_start
        assert pi.run("cat /etc/kept") == "kept\n"
        # what is beyond repair is made anew
        pi.run("sudo dd if=/dev/zero of=/dev/mmcblk0p3 bs=1M count=64 conv=fsync 2>/dev/null")
    with pi.on():
        assert pi.run("hostname; ls /etc/kept 2>/dev/null || true") == "raspberrypi7\n"
        wait_for_the_robot(pi)
