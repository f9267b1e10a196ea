"""Cuts the power of a Raspberry Pi in QEMU at random moments while it starts: `python3 -m tests.bench.cuts`.

Each new card is cut a few times in a row, first in its first start, which has most to lose. Then it is left alone, and
must come to the robot's program. There is a row for each cut, and one for each card that came back.
"""

import argparse
import random
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from tests.cards.conftest import built
from tests.support.polling import until
from tests.support.raspberry_pi import RaspberryPi, put_card_file

FIRST, LATER = 900.0, 240.0  # s after the plug: the latest cut of a card's first start, and of the ones after it
READY = 1800.0  # s of a quiet machine from the login to the robot's program
PLAYS = "no arena announces itself"  # what the program says in a network without one
ANEW = "card: making "  # what the card's first program says when it makes the state
LOG = "sudo journalctl --boot -t laserbot-robot"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cards", type=int, default=25, metavar="N", help="new ones, one after the other (25)")
    parser.add_argument("--cuts", type=int, default=4, metavar="N", help="of each card (4)")
    parser.add_argument("--seed", type=int, default=random.randrange(10**6), metavar="N", help="of the moments")
    arguments = parser.parse_args()
    print(f"seed {arguments.seed}", flush=True)
    chance = random.Random(arguments.seed)
    image = built("robot")
    for number in range(arguments.cards):
        with tempfile.TemporaryDirectory(prefix="laserbot-cuts-") as folder:
            moments = [chance.uniform(0, LATER if earlier else FIRST) for earlier in range(arguments.cuts)]
            try_card(f"card {number + 1}", image, Path(folder), moments)
    print(f"{arguments.cards * arguments.cuts} cuts of {arguments.cards} cards: each came back")


def try_card(name: str, image: Path, folder: Path, moments: list[float]) -> None:
    """AssertionError if the card does not come back. `moments` in s."""
    key, card = folder / "key", folder / "card.img"
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", key], check=True)
    shutil.copy(image, card)
    put_card_file(card, "laserbot.txt", f"ssh_key = {key.with_suffix('.pub').read_text()}".encode())
    pi = RaspberryPi(folder, card, key)
    for moment in moments:
        with pi.on():
            time.sleep(moment)
        said = pi.screen()
        made = "   state made" if ANEW in said else ""
        print(f"{name}: cut after {moment:5.1f} s{made}   {said.splitlines()[-1][:80] if said else ''}", flush=True)
    began = time.monotonic()
    with pi.on():
        until(lambda: PLAYS in pi.run(LOG), READY, "the robot's program runs")
        made = "   state made anew" if ANEW in pi.screen() else ""
        print(f"{name}: back after {time.monotonic() - began:5.1f} s{made}", flush=True)


if __name__ == "__main__":
    main()
