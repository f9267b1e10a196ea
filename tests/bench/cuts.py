"""Cuts the power of cards at random moments, in a machine that QEMU emulates: `python3 -m tests.bench.cuts`.

Each new card is cut several times: during its first start, during later ones, and finally while it gets an update. It
must then come back without help. Each cut prints a line, and so does each step of coming back.

A robot's card has an Arduino on USB and a master in its network, so some cuts come while it plays. It must be one of
its master's robots, drive, and get the update from it. A master's card has no robots until the end. It must serve the
game before it is given the update as a file; after the last cut it must run the update, offer it to robots, and let a
player drive one of two virtual robots in its network.
"""

import argparse
import random
import tempfile
import time
from pathlib import Path

from tests.cards import master_card
from tests.cards.conftest import built, new_key
from tests.cards.hall import SERIAL_PORT, Hall, another_version, given_version
from tests.support.lan import Lan
from tests.support.polling import SLOWNESS, until
from tests.support.raspberry_pi import STAND_IN, Cable, RaspberryPi, arduino, new_card, put_card_file

# the latest that a cut may come, in s of a quiet machine after power-on: in the first start, in a later one, and while
# it gets an update
LATEST = {"robot": (350.0, 105.0, 350.0), "master": (400.0, 150.0, 450.0)}
READY = 1800.0  # s of a quiet machine until it runs the update
VERSION = "9.9.9"
ANEW = "card: making "  # what the card's first program says when it makes something


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("role", nargs="?", choices=sorted(LATEST), default="robot", help="whose cards (default: robot)")
    parser.add_argument("--cards", type=int, default=25, metavar="N", help="new cards, one after another (default: 25)")
    parser.add_argument("--cuts", type=int, default=4, metavar="N", help="cuts per card, at least 2 (default: 4)")
    parser.add_argument(
        "--seed",
        type=int,
        default=random.randrange(10**6),
        metavar="N",
        help="of the moments (default: random)",
    )
    arguments = parser.parse_args()
    if arguments.cuts < 2:
        parser.error("--cuts must be at least 2: one in the first start, and one during the update")
    print(f"seed {arguments.seed}", flush=True)
    chance = random.Random(arguments.seed)
    role = arguments.role
    # a master's update also holds the robots' part
    image = built(*(["robot"] if role == "robot" else ["robot", "master"])) / f"laserbot-{role}.img"
    first, later, updating = LATEST[role]
    latest = [first, *[later] * (arguments.cuts - 2), updating]
    for number in range(arguments.cards):
        moments = [chance.uniform(0, seconds) * SLOWNESS for seconds in latest]
        with tempfile.TemporaryDirectory(prefix="laserbot-cuts-") as folder, Lan() as lan:
            settings = master_card.SETTINGS if role == "master" else ()
            card = Card(f"{role} {number + 1}", image, Path(folder), *settings)
            {"robot": try_robot, "master": try_master}[role](card, lan, moments)
    print(f"{arguments.cards * arguments.cuts} cuts of {arguments.cards} cards: each came back")


class Card:
    """A new one, as an image of its own in that folder. Its laserbot.txt has the SSH key, then `settings`."""

    def __init__(self, name: str, image: Path, folder: Path, *settings: str) -> None:
        self.folder, self.key = folder, new_key(folder)
        self._name = name
        public = self.key.with_suffix(".pub").read_text().strip()
        self.image = new_card(image, folder, f"ssh_key = {public}", *settings)

    def cut(self, pi: RaspberryPi, moment: float) -> None:
        """Switch it on, and pull the plug `moment` s later."""
        with pi.on():
            time.sleep(moment)
        said = pi.screen().splitlines()
        made = [line.partition(ANEW)[2] for line in said if ANEW in line]
        self.tell(f"cut after {moment:5.1f} s   made {made}   {said[-1][:80] if said else ''}")

    def tell(self, what: str) -> None:
        print(f"{self._name}: {what}", flush=True)


def try_robot(card: Card, lan: Lan, moments: list[float]) -> None:
    """AssertionError if it does not come back. `moments` in s, the last one's while an update is there."""
    hall = Hall(lan, card.folder)
    pi = RaspberryPi(card.folder, card.image, card.key, hall.cable, usb=arduino(SERIAL_PORT), board=STAND_IN)
    with hall.master(0) as master, hall.uno() as uno:
        for moment in moments[:-1]:
            card.cut(pi, moment)
        with hall.update(VERSION):
            card.cut(pi, moments[-1])
            began = time.monotonic()
            with pi.on():
                hall.drives(master, uno)
                card.tell(f"drives after {time.monotonic() - began:5.1f} s")
                until(lambda: given_version(pi) == VERSION, READY, "it runs the update")
                hall.drives(master, uno)
                card.tell(f"drives with the update after {time.monotonic() - began:5.1f} s")


def try_master(card: Card, lan: Lan, moments: list[float]) -> None:
    """AssertionError if it does not come back, with its own version or with the update. `moments` as of a robot."""
    pi = RaspberryPi(card.folder, card.image, card.key, Cable(lan.machine()), board=STAND_IN)
    for moment in moments[:-1]:
        card.cut(pi, moment)
    began = time.monotonic()
    with pi.on():
        master_card.serves(pi)
        card.tell(f"serves after {time.monotonic() - began:5.1f} s")
    update = another_version(VERSION, card.folder, Healthcheck=master_card.LIGHT_HEALTH_CHECK)
    put_card_file(card.image, "new.update", update.read_bytes())
    card.cut(pi, moments[-1])
    began = time.monotonic()
    with pi.on():
        master_card.runs_the_update(pi, VERSION)
        card.tell(f"runs the update after {time.monotonic() - began:5.1f} s")
        master_card.drives_robots_beside_it(lan, card.folder)
        card.tell(f"plays after {time.monotonic() - began:5.1f} s")


if __name__ == "__main__":
    main()
