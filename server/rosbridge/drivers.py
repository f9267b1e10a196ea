"""Robots that somebody keeps moving, so that they are stopped when that somebody may no longer drive, or is gone."""

from collections.abc import Hashable

from laser_bot_battle.names import ROBOT_IDS, command_topic
from server.access.identity import Identity
from server.rosbridge.effects import Publish
from server.rosbridge.gate import Gate
from server.rosbridge.shots import Shots

COMMAND_TOPICS = frozenset(map(command_topic, ROBOT_IDS))
NEUTRAL = bytes(3)  # a serialized Robot_msg that neither moves nor shoots


class Drivers:
    """The robots whose last command through this rosbridge was not neutral, each with the client that sent it. What
    stops robots is returned as neutral commands."""

    def __init__(self) -> None:
        self.shots = Shots()
        self._moving: dict[str, tuple[Hashable, Identity]] = {}
        self.commands = 0
        """that clients have published so far"""

    def commanded(self, client: Hashable, who: Identity, topic: str, command: bytes) -> None:
        """`client` has published the serialized `command` on a command topic."""
        self.commands += 1
        if command != NEUTRAL:
            self._moving[topic] = (client, who)
        else:
            self._moving.pop(topic, None)

    def stop(self, client: Hashable, topic: str | None = None) -> list[Publish]:
        """`client` is gone, or no longer advertises `topic`. Robots that another has commanded since keep moving."""
        return self._stop([t for t, (last, _) in self._moving.items() if last is client and topic in (None, t)])

    def stop_refused(self, gate: Gate, now: float) -> list[Publish]:
        """Stops whoever may no longer drive."""
        return self._stop([t for t, (_, who) in self._moving.items() if gate.refuses_publishing(who, t, now)])

    def stop_all(self) -> list[Publish]:
        return self._stop(list(self._moving))

    def _stop(self, topics: list[str]) -> list[Publish]:
        for topic in topics:
            del self._moving[topic]
        return [Publish(topic, NEUTRAL) for topic in topics]
