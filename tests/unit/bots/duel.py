"""A battle without robots, server or real time: minds command, wheels turn as the firmware turns them.

Players see only what /positions tells now and then, a moment late."""

import random
from collections import deque
from collections.abc import Callable, Mapping

from laser_bot_battle.floor import Floor
from laser_bot_battle.geometry import Point, Pose
from server.bots.game import Floor as SeenFloor
from server.bots.game import Positions
from server.bots.mind import FAIR, NEUTRAL, Command, Mind, Skill
from server.bots.paths import Paths
from server.bots.sight import OwnWay, Sight
from sim.arena.world import World
from tests.support.floors import BATTLE_FLOOR

TICK = 0.04  # s between two commands
LATE_TICKS = 1  # from a command to wheels that obey, and from where robots are to the message of it
SEEN_TICKS = 5  # between two messages
SPEED = 1024  # half-steps/s
CURVE = 0.7
PULSE = 0.5  # s

Player = Callable[[float, Pose, Mapping[int, Point]], Command]


def bot(seed: int, skill: Skill = FAIR, floor: Floor = BATTLE_FLOOR) -> Player:
    """A bot that fights everyone."""
    mind = Mind(Paths(floor.width, floor.height, floor.walls), random.Random(seed), skill)
    return lambda now, me, others: mind.decide(now, me, others, set(others))


def idle(_now: float, _me: Pose, _others: Mapping[int, Point]) -> Command:
    """Somebody who does nothing."""
    return NEUTRAL


def wheel_speeds(command: Command) -> tuple[float, float]:
    """Half-steps/s (left, right), signed as the firmware's movement table."""
    linear, angular = command.linear_x, command.angular_z
    if linear == 0:
        return -SPEED * angular, -SPEED * angular
    left, right = -SPEED * linear, SPEED * linear
    return (left * CURVE if angular < 0 else left), (right * CURVE if angular > 0 else right)


class Duel:
    """Players by robot ID in a world; time passes by `run`."""

    def __init__(self, players: Mapping[int, Player], floor: Floor = BATTLE_FLOOR) -> None:
        self.world = World(floor)
        self.now = 0.0
        self.shots: dict[int, list[float]] = {number: [] for number in players}
        self._players = players
        self._wheels = dict.fromkeys(players, (0.0, 0.0))
        self._pending = {number: deque([NEUTRAL] * LATE_TICKS) for number in players}
        self._sight, self._told = Sight(), deque[Positions](maxlen=LATE_TICKS + 1)
        self._ways = {number: OwnWay() for number in players}
        self._ticks = 0
        for number in players:
            self.world.arrive(f"virtual{number}")
            self.world.turn_wheels(f"virtual{number}", 0, 0)

    def hits(self, number: int) -> int:
        return self.world.robots[f"virtual{number}"].hits

    def place(self, number: int, pose: Pose) -> None:
        self.world.robots[f"virtual{number}"].pose = pose

    def pose(self, number: int) -> Pose:
        return self.world.robots[f"virtual{number}"].pose

    def run(self, seconds: float, until: Callable[..., bool] = lambda: False) -> float:
        """Let time pass; returns the time at which `until` became true, or the time after `seconds`."""
        end = self.now + seconds
        while self.now < end and not until():
            self._look()
            for number, player in self._players.items():
                seen = self._sight.seen(number, self.now)
                assert seen
                others = {other: point for other, point in self._sight.points(self.now).items() if other != number}
                command = player(self.now, self._ways[number].since(*seen, self.now), others)
                self._ways[number].commanded(self.now, command)
                self._pending[number].append(command)
                self._obey(number, self._pending[number].popleft())
            self.world.update_light()
            self.now += TICK
        return self.now

    def _look(self) -> None:
        floor = self.world.floor
        seen = SeenFloor(floor.width, floor.height, tuple(floor.walls))
        self._told.append(Positions(seen, {number: self.pose(number) for number in self._players}))
        if self._ticks % SEEN_TICKS == 0:
            self._sight.see(self.now, self._told[0])
        self._ticks += 1

    def _obey(self, number: int, command: Command) -> None:
        name = f"virtual{number}"
        speeds = wheel_speeds(command)
        left, right = (at + speed * TICK for at, speed in zip(self._wheels[number], speeds, strict=True))
        self._wheels[number] = (left, right)
        self.world.turn_wheels(name, round(left), round(right))
        lit_since = self.shots[number][-1] if self.shots[number] else -PULSE
        if command.shoot and self.now - lit_since >= PULSE:
            self.shots[number].append(self.now)
            lit_since = self.now
        self.world.set_beam(name, self.now - lit_since < PULSE)
