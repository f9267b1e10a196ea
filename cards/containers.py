"""The containers of a card, as its engine is asked for them."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from cards.laserbot_txt import Card
from laser_bot_battle import variables

# Of the containers that are a card's own. One without it is from Ansible, which has deployed to the host.
LABEL = "laserbot.card"

Container = dict[str, Any]  # the body of the engine's /containers/create


def containers(card: Card, host: str, described: Mapping[str, Container]) -> dict[str, Container]:
    """By name: those that a card with these settings runs on the host `host`.

    `described` are those that the fleet's roles would run: robot and camera, or all of a master's.
    """
    settings = {variables.ARENA_NAME.name: card.arena} if card.arena else {}
    if card.role == "master":
        return {f"laserbot-{name}": _set(container, settings) for name, container in described.items()}
    settings[variables.ROBOT_NAME.name] = host
    if card.camera:
        settings[variables.CAMERA.name] = card.camera
    found = {"laserbot-robot": _set(described["robot"], settings)}
    if card.camera:
        found["laserbot-camera"] = _set(described["camera"], settings)
    return found


def _set(container: Container, settings: Mapping[str, str]) -> Container:
    """The container with those of the settings that it has, and with a label that says what it was made from."""
    environment = dict(entry.split("=", 1) for entry in container["Env"])
    environment.update({name: value for name, value in settings.items() if name in environment})
    changed = {**container, "Env": [f"{name}={value}" for name, value in environment.items()]}
    digest = hashlib.sha256(json.dumps(changed, sort_keys=True).encode()).hexdigest()
    return {**changed, "Labels": {LABEL: digest}}
