"""The rules of place: what the referee decides by where the robots are. Pure.

They hold for real and virtual robots alike. What is not seen is decided as if there were no such rule.
"""

import math
from collections.abc import Iterator, Sequence

from laser_bot_battle.floor import Zone
from laser_bot_battle.names import Game
from server.game.hill import Hill, is_in
from server.game.pickups import LASTS, REPAIR, REPAIRED
from server.game.place_events import EffectEnded, Fenced, HillHeld, HillOpened, PickedUp, PickUpLaid, PlaceEvent
from server.game.rules import Rules
from server.game.sight import FREE, Moment, Sight, beyond
from server.game.snapshot import Place
from server.game.state import State
from server.game.users import FULL_LIFE, User

SEEN = 1.0  # s after which a place is no longer known
RULES = ("fence", "hill", "pickups", "line_of_fire")  # those that are here


class Places:
    """What is known of where robots are. It outlives no program: the next picture tells it anew."""

    def __init__(self, zones: Sequence[Zone] = ()) -> None:
        """`zones` of the floor that the robots are on."""
        self._hills = [zone for zone in zones if zone.kind == "hill"]
        self._spots = [zone for zone in zones if zone.kind == "pick-up"]
        self._sight, self._hill = Sight(), Hill()
        self._seen_at = -math.inf
        self._opened = 0  # battle whose hills were told

    def begin(self) -> None:
        """A battle begins, or its clock stands or goes on."""
        self._hill = Hill()

    def are_known(self, now: float) -> bool:
        """Whether somebody tells where robots are, if there are any."""
        return now - self._seen_at <= SEEN

    def may_have_met(self, shooter: int, victim: int, rules: Rules, now: float) -> bool:
        """Whether light of one robot may have met the other a moment ago."""
        return not rules.line_of_fire or self._sight.may_have_met(shooter, victim, rules.line_of_fire, now)

    def see(self, moment: Moment, size: tuple[float, float], state: State, rules: Rules) -> Iterator[PlaceEvent]:
        """What is to be decided, one after the other, when robots are seen on a floor of that width and height (m)."""
        self._sight.see(moment)
        self._seen_at = moment.at
        for user in state.users:
            pose = moment.poses.get(user.robot) if rules.fence else None
            sides = beyond(pose, *size, user.fence) if pose else FREE
            if user.fence != sides:
                yield Fenced(user.name, user.robot, sides.ahead, sides.behind)
        if state.game is Game.PLAYING and state.paused_at is None:
            if rules.hill:
                yield from self._opened_in(state.battle)
                yield from self._earned(moment, state)
            yield from self._taken(moment, state)

    def deadlines(self, state: State, rules: Rules) -> Iterator[tuple[float, PlaceEvent]]:
        """What is to be decided, and when, if nothing happens before."""
        for user in state.users:
            if user.fence != FREE:
                yield self._seen_at + SEEN, Fenced(user.name, user.robot, False, False)
        if state.game is not Game.PLAYING or state.paused_at is not None:
            return
        for user in state.users:
            for kind, until in user.effects.items():
                yield until, EffectEnded(user.name, user.robot, kind)
        if rules.pickups:
            for at, spot, kind in state.pickups.due(self._spots, rules.pickups, state.began_at):
                yield at, PickUpLaid(spot.name, kind, spot.x, spot.y, spot.radius)

    def shown(self, state: State, rules: Rules) -> tuple[Place, ...]:
        """What players are to see on the floor."""
        hills = [Place("hill", hill.x, hill.y, hill.radius) for hill in self._hills if rules.hill]
        lying = [
            Place(kind, spot.x, spot.y, spot.radius)
            for spot in self._spots
            if (kind := state.pickups.lying.get(spot.name)) is not None
        ]
        return (*hills, *lying)

    def _opened_in(self, battle: int) -> Iterator[HillOpened]:
        if self._opened != battle:
            self._opened = battle
            for hill in self._hills:
                yield HillOpened(hill.name, hill.x, hill.y, hill.radius)

    def _earned(self, moment: Moment, state: State) -> Iterator[HillHeld]:
        fighters = {user.robot: user for user in state.users.get_users_alive()}
        sides = {robot: user.team or user.name for robot, user in fighters.items()}
        for robot, hill in self._hill.see(moment, self._hills, sides):
            points = fighters[robot].points + 1
            yield HillHeld(fighters[robot].name, robot, points, hill.x, hill.y, hill.radius)

    def _taken(self, moment: Moment, state: State) -> Iterator[PickedUp]:
        for spot in self._spots:
            kind = state.pickups.lying.get(spot.name)
            if kind is not None and (taker := _first(spot, moment, state)):
                life = min(FULL_LIFE, taker.life + REPAIRED) if kind == REPAIR else taker.life
                yield PickedUp(taker.name, taker.robot, spot.name, kind, life, LASTS[kind])


def _first(spot: Zone, moment: Moment, state: State) -> User | None:
    """Of the fighters who are there, the one nearest to its middle."""
    there = [
        (math.dist((spot.x, spot.y), moment.poses[user.robot][:2]), user.robot, user)
        for user in state.users.get_users_alive()
        if user.robot in moment.poses and is_in(spot, moment.poses[user.robot])
    ]
    return min(there)[-1] if there else None
