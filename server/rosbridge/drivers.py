"""Robots that somebody keeps moving, so that they are stopped when that somebody may no longer, or is gone."""

import re
from typing import Any

from server.rosbridge.gate import Gate, Identity

COMMANDS = re.compile(r"/Robot\d+/command", re.ASCII)


def is_command_topic(topic: str) -> bool:
    return COMMANDS.fullmatch(topic) is not None


class Drivers:
    """The robots whose last command through this rosbridge was not neutral, each with the one who sent it."""

    def __init__(self) -> None:
        self._moving: dict[str, tuple[object, Identity]] = {}

    def commanded(self, client: object, who: Identity, topic: str, message: Any) -> None:
        """`client` (a session) has published the Robot_msg `message` on `topic`."""
        if not is_command_topic(topic):
            return
        if message.linear_x or message.angular_z or message.shoot:
            self._moving[topic] = (client, who)
        else:
            self._moving.pop(topic, None)

    def left(self, client: object, topic: str | None = None) -> list[str]:
        """The topics to stop because `client` is gone, or no longer advertises `topic`. The last to command counts."""
        return self._stop([t for t, (last, _) in self._moving.items() if last is client and topic in (None, t)])

    def refused(self, gate: Gate, now: float) -> list[str]:
        """The topics to stop because who keeps them moving may no longer."""
        return self._stop([t for t, (_, who) in self._moving.items() if gate.refuses_publishing(who, t, now)])

    def all(self) -> list[str]:
        """All topics to stop."""
        return self._stop(list(self._moving))

    def _stop(self, topics: list[str]) -> list[str]:
        for topic in topics:
            del self._moving[topic]
        return topics
