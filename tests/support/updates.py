"""Versions of the game for cards, without anything that is large, and a card that starts."""

import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from copy import deepcopy
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from cards import archive, trial
from cards.laserbot_txt import Card
from cards.run import run
from cards.store import Store
from cards.telling import ERRORS, tell, tell_mistakes
from cards.update import update
from tests.support.card_engine import CardEngine

IMAGES = {"robot": "rosberry", "master": "webserver"}
CONTAINERS = {"robot": ("robot", "camera"), "master": ("web", "announcer")}
STEPS = ("fsync", "mkdir", "rename", "replace", "rmdir", "symlink", "unlink")


def image(role: str, version: str) -> str:
    """Of 1 and 1+x it is the same."""
    return f"{IMAGES[role]}:x-{version.partition('+')[0]}"


def part(folder: Path, role: str, version: str) -> None:
    """What a card with this role has of that version."""
    (folder / "containers").mkdir(parents=True)
    for name in (*CONTAINERS[role], *(["of-2"] if (role, version) == ("master", "2") else [])):
        described = {"Image": image(role, version), "Env": ["LASERBOT_ARENA="]}
        (folder / f"containers/{name}.json").write_text(json.dumps(described))
    (folder / "image.tar").write_text(f"{IMAGES[role]}:x {image(role, version)}")


def write_update(target: Path, version: str) -> None:
    folder = target.with_suffix(".folder")
    for role in IMAGES:
        part(folder / role, role, version)
    archive.write(version, folder, target)
    shutil.rmtree(folder)


class FakeClock:
    def __init__(self) -> None:
        self.now = 0.0

    def rest(self, seconds: float) -> None:
        self.now += seconds


class CardHost:
    """A card in a Raspberry Pi, as far as versions go; its own is 1."""

    def __init__(self, folder: Path, role: str) -> None:
        self.boot = folder / "boot"
        self.boot.mkdir(parents=True)
        part(folder / "card", role, "1")
        (folder / "card/role").write_text(f"{role}\n")
        (folder / "card/version").write_text("1\n")
        self._folder = folder
        self.role = role
        self.engine = CardEngine()
        self.restarts = 0  # that its own programs have asked for
        self.store = Store(folder / "state", folder / "card")

    def copy(self, folder: Path) -> "CardHost":
        shutil.copytree(self._folder, folder, symlinks=True)
        other = deepcopy(self)
        other.__dict__.update(_folder=folder, boot=folder / "boot", store=Store(folder / "state", folder / "card"))
        return other

    def start(self, **settings: Any) -> None:
        """It is switched on; `settings` are those of its laserbot.txt."""
        card = Card(role=self.role, **settings)
        unsound = self._folder / "state/engine-unsound"
        if unsound.exists():  # as cards/boot/init does
            self.engine.lose_files()
            unsound.unlink()
        tell_mistakes(self.boot, [])
        update(self.boot, self.store, card, self.engine)
        self.settle(card)

    def settle(self, card: Card, tries: int = 0) -> None:
        """`tries` have failed since it was switched on."""
        clock = FakeClock()
        steady = partial(trial.steady, clock=lambda: clock.now, rest=clock.rest)
        telling = partial(tell, self.boot)
        run(self.engine, self.store, card, "host", tell=telling, tries=tries, restart=self._restart, steady=steady)

    def _restart(self) -> None:
        self.restarts += 1

    @property
    def told(self) -> list[str]:
        """In the file for people."""
        path = self.boot / ERRORS
        return path.read_text().splitlines() if path.exists() else []

    @property
    def runs(self) -> str:
        """The version that its containers are of."""
        [found] = {one["Config"]["Image"].rpartition("-")[2] for one in self.engine.containers.values()}
        assert {one["State"]["Status"] for one in self.engine.containers.values()} == {"running"}
        return str(found)

    @property
    def serves(self) -> archive.Manifest:
        return archive.parse((self.store.served / archive.MANIFEST).read_bytes())


class Cut(BaseException):
    """The power is gone."""


@contextmanager
def power(steps: int, engine: CardEngine, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """For so many changes of the file systems and the engine; then `Cut`."""
    done = 0
    engine.sync()  # what is old is on the disk

    def counted(function: Any) -> Any:
        def run(*arguments: Any, **options: Any) -> Any:
            nonlocal done
            if function.__name__ == "ask" and arguments[0] == "GET":
                return function(*arguments, **options)
            if done == steps:
                raise Cut
            done += 1
            return function(*arguments, **options)

        return run

    with monkeypatch.context() as patch:
        for name in STEPS:
            patch.setattr(os, name, counted(getattr(os, name)))
        patch.setattr(os, "sync", counted(engine.sync))
        patch.setattr(engine, "ask", counted(engine.ask))
        try:
            yield
        except Cut:
            engine.lose_power()
            raise
