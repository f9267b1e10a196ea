"""A card has every package that a host of the fleet needs: none is fetched when it is deployed to."""

import re
from pathlib import Path

import yaml

from tests.support.programs import ROOT


def packages(path: Path) -> set[str]:
    return {line.split("#")[0].strip() for line in path.read_text().splitlines()} - {""}


def test_a_card_has_what_a_host_has_and_what_the_roles_would_install() -> None:
    settings = yaml.safe_load((ROOT / "ansible/roles/host/vars/main.yml").read_text())
    needed = {*settings["host_packages_of_all"], *re.findall(r"\['([\w-]+)'\]", settings["host_packages"])}
    assert {"docker-cli", "unattended-upgrades", "chrony"} <= needed
    needed |= packages(ROOT / "tests/fleet/host/packages.txt") - {"systemd-timesyncd"}  # which chrony replaces
    assert not needed - packages(ROOT / "images/card.packages")


def test_the_lock_has_them_all() -> None:
    locked = {line.split()[1].rpartition("/")[2].split("_")[0] for line in lock_lines()}
    assert not packages(ROOT / "images/card.packages") - locked


def lock_lines() -> list[str]:
    return (ROOT / "images/card.lock").read_text().splitlines()[1:]
