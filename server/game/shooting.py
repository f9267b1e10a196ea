"""Which shot a reported hit is: pure rules.

A hit counts only while the light of a shot that another living fighter has fired may be what was seen, and a shot costs
each robot life only once.
"""

from collections.abc import Iterable

from laser_bot_battle.light_protocol import COOLDOWN
from server.game.emitter import PULSE, Emitter, Shot
from server.game.users import User


class Shooting:
    """The shots of late. They outlive no program: by then their light is gone."""

    def __init__(self) -> None:
        self._emitters: dict[int, Emitter] = {}

    def fire(self, robot_id: int, fighter: User, now: float) -> bool:
        """The fighter's robot is told to shoot; whether it can have done so, by its cooldown."""
        emitter = self._emitters.setdefault(robot_id, Emitter())
        return emitter.fire(Shot(now, fighter.name, fighter.team))

    def plain_hit(self, robot_id: int, victim: User, friendly_fire: bool, now: float) -> str | None:
        """Light was seen that does not tell whose it is: the shooter, "" if it may be one of several, None if it can be
        nobody's."""
        shots = [
            shot
            for robot, emitter in self._emitters.items()
            if robot != robot_id
            for shot in _that_may_meet(robot_id, victim, emitter.shots, friendly_fire)
            if shot.is_under_way(now, PULSE)
        ]
        if not shots:
            return None
        min(shots, key=lambda shot: shot.at).met.add(robot_id)
        shooters = {shot.by for shot in shots}
        return shooters.pop() if len(shooters) == 1 else ""

    def coded_hit(self, robot_id: int, victim: User, shooter: int, friendly_fire: bool, now: float) -> str | None:
        """A packet of the robot `shooter` was seen: its fighter, None if that one has not fired it."""
        emitter = self._emitters.get(shooter)
        if emitter is None or shooter == robot_id:
            return None
        for shot in _that_may_meet(robot_id, victim, emitter.shots, friendly_fire):
            # A trigger that is pulled while the robot cools down fires later than its news. The packet names the robot,
            # so that nobody else's light can be taken for it.
            if shot.is_under_way(now, COOLDOWN):
                shot.met.add(robot_id)
                return shot.by
        return None


def _that_may_meet(robot_id: int, victim: User, shots: Iterable[Shot], friendly_fire: bool) -> Iterable[Shot]:
    for shot in shots:
        is_friend = shot.team != 0 and shot.team == victim.team
        if robot_id not in shot.met and shot.by != victim.name and (friendly_fire or not is_friend):
            yield shot
