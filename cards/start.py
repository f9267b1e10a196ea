"""Makes the host what laserbot.txt says, at each start before anything else asks who it is.

    python3 -m cards.start [--boot FOLDER] [--root FOLDER]

A setting that is not there leaves everything as it is: whoever deploys to the host by Ansible may have decided it.
What is wrong in the file is told on the screen and in laserbot-errors.txt beside it; without mistakes there is no such
file. Nothing is written that is as it should be already.
"""

import argparse
import os
import shutil
import sys
import zoneinfo
from pathlib import Path

from cards.backups import restore
from cards.files import HOST_NAME, File, files, own_name
from cards.laserbot_txt import FILE, LONGEST, Card, Mistake, parse, without_secrets
from cards.telling import tell_mistakes
from cards.values import MOVE


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--boot", type=Path, default=Path("/boot/firmware"), help="the card's first partition")
    parser.add_argument("--root", type=Path, default=Path("/"), help="the system")
    arguments = parser.parse_args()
    start(arguments.boot, arguments.root, own_role())
    return 0


def own_role() -> str:
    """The card's, one of ROLES."""
    return (Path(__file__).resolve().parents[1] / "role").read_text().strip()


def start(boot: Path, root: Path, role: str) -> None:
    card, mistakes = read(boot, role)
    decided = files(card)
    if not (root / HOST_NAME[1:]).exists():
        decided.setdefault(HOST_NAME, File(f"{own_name(_serial(root))}\n"))
    for path, file in decided.items():
        put(root / path[1:], file)
    if card.secrets == MOVE and not mistakes:
        _move_secrets(boot / FILE, role)
    tell_mistakes(boot, mistakes)
    if role == "master":
        restore(boot, root)


def _move_secrets(path: Path, role: str) -> None:
    """Off the partition that every computer shows, once what they have become is on the other."""
    os.sync()
    try:
        with path.open("r+b") as old:
            content = old.read()
            rest = without_secrets(content, zoneinfo.available_timezones(), role)
            if rest == content:
                return
            new = path.with_name(f"{path.name}.new")
            with new.open("wb") as file:
                file.write(rest)
                file.flush()
                os.fsync(file.fileno())
            new.replace(path)
            os.sync()
            # the old one has no name any more, but its content would stay on the card
            old.seek(0)
            old.write(bytes(len(content)))
            old.flush()
            os.fsync(old.fileno())
    except (OSError, ValueError) as error:
        print(f"{path}: the secrets stay there: {error}", file=sys.stderr)


def read(boot: Path, role: str) -> tuple[Card, list[Mistake]]:
    """What the file on the first partition says to a card with this role, and the file's mistakes."""
    content, mistakes = _read(boot / FILE)
    card, wrong = parse(content, zoneinfo.available_timezones(), role)
    return card, mistakes + wrong


def _read(path: Path) -> tuple[bytes, list[Mistake]]:
    """The file's beginning. A partition that cannot be read is as good as a file that is not there."""
    try:
        with path.open("rb") as file:
            return file.read(LONGEST + 1), []
    except OSError as error:
        return b"", [Mistake(0, f"cannot be read: {error.strerror}")]


def _serial(root: Path) -> str:
    try:
        return (root / "proc/device-tree/serial-number").read_text().strip("\0\n")
    except OSError:  # not a Raspberry Pi
        return ""


def put(path: Path, file: File) -> None:
    """Atomically: the power may go at any moment."""
    if file.link:
        if path.is_symlink() and os.readlink(path) == file.content:
            return
    elif path.is_file() and not path.is_symlink() and path.read_bytes() == file.content.encode():
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_name(f"{path.name}.new")
    new.unlink(missing_ok=True)
    if file.link:
        new.symlink_to(file.content)
    else:
        with open(new, "x", opener=lambda name, flags: os.open(name, flags, file.mode)) as opened:
            opened.write(file.content)
            opened.flush()
            os.fsync(opened.fileno())
        if file.owner != "root":
            shutil.chown(new, file.owner, file.owner)
    new.replace(path)


if __name__ == "__main__":
    sys.exit(main())
