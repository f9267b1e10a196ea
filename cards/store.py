"""The versions of the game that a card has, on the partition of its state.

    state.json             what the card remembers of them (cards/versions.py)
    versions/VERSION/      one that is there whole: manifest.json, ROLE/image.tar, ROLE/containers/NAME.json
    engine-unsound         the engine's images and containers are to be made anew at the next start (cards/boot/init)
    engine-made-anew       that was tried, and has not helped yet
    served/                on a master, what the robots may read: manifest.json, and robot/ of the version that it runs

The card's own version is where the card was made, in its system, which nothing writes. The power may go at any moment.
"""

import json
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from cards.archive import MANIFEST, Manifest, description, parse, render
from cards.files import File
from cards.start import put
from cards.versions import State, kept

ROOM = 5  # times its size is what a version takes, with its images in the engine
_HEALTHY = "healthy.json"
_UNSOUND, _ANEW = "engine-unsound", "engine-made-anew"
# in versions/, where no version begins with a dot
_NEW, _OLD = ".new", ".old"


class Store:
    def __init__(self, folder: Path, card: Path) -> None:
        """`card`: where the card's own version is."""
        self._folder = folder
        self._card = card
        self._versions = folder / "versions"
        self.served = folder / "served"

    @property
    def own(self) -> str:
        """The card's own version."""
        return (self._card / "version").read_text().strip()

    def state(self) -> State:
        try:
            known = json.loads((self._folder / "state.json").read_bytes())
            return State(**{**known, "refused": tuple(known["refused"])})
        except (OSError, ValueError, TypeError, KeyError):
            return State(self.own, self.own)

    def remember(self, state: State) -> None:
        """It outlasts the power."""
        put(self._folder / "state.json", File(json.dumps(asdict(state)) + "\n"))
        _sync(self._folder)

    def healthy(self) -> set[str]:
        """The containers that were so with the version that ran last; none if nothing is known."""
        try:
            return set(json.loads((self._folder / _HEALTHY).read_bytes()))
        except (OSError, ValueError, TypeError):
            return set()

    def remember_healthy(self, names: set[str]) -> None:
        """It outlasts the power."""
        put(self._folder / _HEALTHY, File(json.dumps(sorted(names)) + "\n"))
        _sync(self._folder)

    @contextmanager
    def loading(self) -> Iterator[None]:
        """While the engine loads an image: it says that it has before all of it is on the card (moby#49784), and never
        looks again. If the power goes meanwhile, the next start knows."""
        self._mark(_UNSOUND)
        try:
            yield
        finally:
            os.sync()
            (self._folder / _UNSOUND).unlink(missing_ok=True)

    def give_up_the_engine(self) -> bool:
        """Have its images and containers made anew at the next start; False if that has not helped the last time."""
        if (self._folder / _ANEW).exists():
            return False
        self._mark(_UNSOUND)
        self._mark(_ANEW)
        return True

    def engine_is_well(self) -> None:
        (self._folder / _ANEW).unlink(missing_ok=True)

    def _mark(self, name: str) -> None:
        """It outlasts the power."""
        put(self._folder / name, File(""))
        _sync(self._folder)

    def stored(self) -> set[str]:
        """The versions that are there whole; the card's own need not be."""
        return {path.name for path in _entries(self._versions) if path.name not in (_NEW, _OLD)}

    def manifest(self, version: str) -> Manifest:
        """Of a stored version, as it came."""
        return parse((self._versions / version / MANIFEST).read_bytes())

    def image(self, version: str) -> Path:
        """The archive of the image that the containers of that version run."""
        return self._home(version) / "image.tar"

    def described(self, version: str) -> dict[str, Any]:
        """The containers of that version, by name. ValueError if the card is broken."""
        return {path.stem: description(path) for path in (self._home(version) / "containers").iterdir()}

    def add(self, manifest: Manifest, fill: Callable[[Path], None]) -> None:
        """Store a version: `fill` writes its files into a folder. ValueError if there is no room for it."""
        self._versions.mkdir(parents=True, exist_ok=True)
        new = self._versions / _NEW
        shutil.rmtree(new, ignore_errors=True)
        free = shutil.disk_usage(self._versions).free
        if free < ROOM * manifest.size:
            raise ValueError(f"needs {ROOM * manifest.size >> 20} MiB on the card, which has {free >> 20}")
        try:
            new.mkdir()
            fill(new)
            put(new / MANIFEST, File(render(manifest)))
        except Exception:
            shutil.rmtree(new, ignore_errors=True)
            raise
        new.rename(self._versions / manifest.version)
        _sync(self._versions)

    def tidy(self, state: State) -> None:
        """Remove the versions that are not kept."""
        old = self._versions / _OLD
        shutil.rmtree(old, ignore_errors=True)
        for path in _entries(self._versions):
            if path.name not in kept(state):
                shutil.rmtree(path.rename(old))  # half a version is none

    def serve(self, version: str, arena: str) -> None:
        """Give the robots that version; of the master's own, if it is not stored, they only get the name."""
        has_files = version in self.stored()
        manifest = self.manifest(version).of("robot") if has_files else Manifest(version, {})
        put(self.served / "robot", File(f"../versions/{version}/robot", link=True))
        put(self.served / MANIFEST, File(render(manifest._replace(arena=arena))))

    def _home(self, version: str) -> Path:
        role = (self._card / "role").read_text().strip()
        return self._versions / version / role if version in self.stored() else self._card


def _entries(folder: Path) -> list[Path]:
    return sorted(folder.iterdir()) if folder.is_dir() else []


def _sync(folder: Path) -> None:
    """What was made or renamed in the folder outlasts the power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
