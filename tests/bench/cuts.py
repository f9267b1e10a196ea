"""Cuts the power of a robot with a card at random moments: `python3 -m tests.bench.cuts`. QEMU emulates it.

Each new card, with an Arduino on USB and a master in its network, is cut a few times in a row: during its first start,
during later ones or while it plays, and at last while its master gives it an update. Then it is left alone and must
come back: it must be one of its master's robots, drive, and get the update. There is a row for each cut, and two for
each card.
"""

import argparse
import random
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from tests.cards.conftest import built
from tests.cards.hall import SERIAL_PORT, Hall, given_version
from tests.support.lan import Lan
from tests.support.polling import SLOWNESS, until
from tests.support.raspberry_pi import STAND_IN, RaspberryPi, arduino, put_card_file

# the latest moment of a cut, in s of a quiet machine after power-on: in a card's first start, in a later one, in one in
# which an update comes
FIRST, LATER, UPDATING = 350.0, 105.0, 350.0
READY = 1800.0  # s of a quiet machine until it has come back
VERSION = "9.9.9"
ANEW = "card: making "  # what the card's first program says when it makes something


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cards", type=int, default=25, metavar="N", help="new ones, one after the other (25)")
    parser.add_argument("--cuts", type=int, default=4, metavar="N", help="of each card (4)")
    parser.add_argument("--seed", type=int, default=random.randrange(10**6), metavar="N", help="of the moments")
    arguments = parser.parse_args()
    print(f"seed {arguments.seed}", flush=True)
    chance = random.Random(arguments.seed)
    image = built("robot") / "laserbot-robot.img"
    for number in range(arguments.cards):
        latest = [FIRST, *[LATER] * (arguments.cuts - 2), UPDATING][: arguments.cuts]
        moments = [chance.uniform(0, seconds) * SLOWNESS for seconds in latest]
        with tempfile.TemporaryDirectory(prefix="laserbot-cuts-") as folder, Lan() as lan:
            try_card(f"card {number + 1}", image, Path(folder), lan, moments)
    print(f"{arguments.cards * arguments.cuts} cuts of {arguments.cards} cards: each came back")


def try_card(name: str, image: Path, folder: Path, lan: Lan, moments: list[float]) -> None:
    """AssertionError if the card does not come back. `moments` in s, the last one's while an update is there."""
    key, card = folder / "key", folder / "card.img"
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", key], check=True)
    shutil.copy(image, card)
    put_card_file(card, "laserbot.txt", f"ssh_key = {key.with_suffix('.pub').read_text()}".encode())
    hall = Hall(lan, folder)
    pi = RaspberryPi(folder, card, key, hall.cable, usb=arduino(SERIAL_PORT), board=STAND_IN)

    def cut(moment: float) -> None:
        with pi.on():
            time.sleep(moment)
        said = pi.screen().splitlines()
        made = [line.partition(ANEW)[2] for line in said if ANEW in line]
        print(f"{name}: cut after {moment:5.1f} s   made {made}   {said[-1][:80] if said else ''}", flush=True)

    with hall.master(0) as master, hall.uno() as uno:
        for moment in moments[:-1]:
            cut(moment)
        with hall.update(VERSION):
            cut(moments[-1])
            began = time.monotonic()
            with pi.on():
                hall.drives(master, uno)
                print(f"{name}: drives after {time.monotonic() - began:5.1f} s", flush=True)
                until(lambda: given_version(pi) == VERSION, READY, "it runs the update")
                hall.drives(master, uno)
                print(f"{name}: drives with the update after {time.monotonic() - began:5.1f} s", flush=True)


if __name__ == "__main__":
    main()
