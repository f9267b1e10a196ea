"""Takes another version of the game from the card's first partition, at each start.

    python3 -m cards.update [--boot FOLDER]

A person has copied it there, to the master's card: a file whose name ends in .update (cards/archive.py). It is gone
from there once it is stored; cards.run then tries it. One that cannot be used stays, and is told on the screen and in
laserbot-errors.txt.
"""

import argparse
import sys
from pathlib import Path

from cards.archive import manifest_of, unpack
from cards.containers import containers
from cards.engine import Engine, EngineError, Socket
from cards.files import STATE
from cards.laserbot_txt import Card
from cards.run import ENGINE, HERE, is_deployed_to
from cards.start import own_role, read
from cards.store import Store
from cards.telling import tell
from cards.values import PREVIOUS
from cards.versions import taken
from laser_bot_battle.settings import shown

SUFFIX = ".update"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--boot", type=Path, default=Path("/boot/firmware"), help="the card's first partition")
    arguments = parser.parse_args()
    card, _ = read(arguments.boot, own_role())
    update(arguments.boot, Store(STATE, HERE), card, Socket(ENGINE))
    return 0


def update(boot: Path, store: Store, card: Card, engine: Engine) -> None:
    # a Mac leaves files like ._laserbot.update beside those that it copies
    there = list(boot.iterdir()) if boot.is_dir() else []
    found = [path for path in there if path.suffix.lower() == SUFFIX and not path.name.startswith(".")]
    for path in sorted(found):
        try:
            if card.role != "master":
                raise ValueError("is for the master's card, from which the robots get it")
            if len(found) > 1:
                raise ValueError("is not the only one: leave one on the card")
            if is_deployed_to(engine, containers(card, "", store.described(store.own))):
                raise ValueError("is not for a host to which Ansible has deployed: take update.yml")
            _take(path, store, card.version == PREVIOUS)
            if card.version == PREVIOUS:
                tell(boot, shown(path.name), "is taken, and runs once laserbot.txt no longer says version = previous")
        except (EngineError, ValueError) as error:
            tell(boot, shown(path.name), str(error))
        except OSError as error:
            tell(boot, shown(path.name), f"cannot be taken: {error.strerror or error}")


def _take(path: Path, store: Store, back: bool) -> None:
    """ValueError says why it cannot be used; OSError if it, or the card, cannot be read or written."""
    manifest = manifest_of(path)
    if manifest.version not in store.stored():
        store.add(manifest, lambda folder: unpack(path, manifest, folder))
    elif store.manifest(manifest.version) != manifest:
        raise ValueError(f"is another {manifest.version} than the one that is here already")
    store.remember(taken(store.state(), manifest.version, back))
    path.unlink()
    print(f"{path.name}: taken", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
