"""Robots on the arena's floor, a picture of the camera above, and the tracker that looks at it, in simulated time."""

import math
import random
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple

from laser_bot_battle.apriltag import Detector
from laser_bot_battle.floor import Floor
from laser_bot_battle.geometry import wrap
from server.overhead.robots import Seen
from server.overhead.tracker import Tracker
from sim.arena.cameras.streams import scene_of
from sim.arena.overhead.conditions import Conditions
from sim.arena.overhead.lens import HEIGHT, WIDTH
from sim.arena.overhead.picture import TAG_HEIGHT, Painter
from sim.arena.overhead.room import Room
from sim.arena.world import Robot, World

RATE = 15  # pictures a second
SPEED = 1024  # half-steps/s of a wheel at full speed
CURVE = 0.7  # of it, of the inner wheel in a curve
TURNS = 4  # between two pictures in which wheels turn

Command = tuple[int, int]  # linear_x and angular_z of Robot_msg
STOP: Command = (0, 0)


class Miss(NamedTuple):
    """How far a place is from the true one."""

    distance: float  # m
    angle: float  # degrees


class Hall:
    """Robots 0, 1, ... stand where they start."""

    def __init__(self, floor: Floor, robots: int, conditions: Conditions | None = None) -> None:
        self.conditions = conditions or Conditions()
        self.world = World(floor)
        self._wheels = [(0.0, 0.0)] * robots
        for number in range(robots):
            self.world.arrive(_name(number))
            self.world.turn_wheels(_name(number), 0, 0)
        self._painter = Painter(Room(floor, self.conditions))
        self._detector = Detector(2)
        self.tracker = Tracker(floor, self.conditions.height, TAG_HEIGHT)
        self.now = 0.0
        self.painting = self.finding = 0.0  # s of processor time for the last picture

    def robot(self, number: int) -> Robot:
        return self.world.robots[_name(number)]

    def drive(self, commands: Callable[[int], Command] | None, seconds: float) -> None:
        """By the same commands for each robot all the time, which the tracker hears."""
        for number in range(len(self._wheels)):
            linear_x, angular_z = commands(number) if commands else STOP
            self.tracker.command(number, linear_x, angular_z, self.now)
            left, right = _speeds(linear_x, angular_z)
            for _ in range(TURNS):
                before = self._wheels[number]
                self._wheels[number] = before[0] + left * seconds / TURNS, before[1] + right * seconds / TURNS
                self.world.turn_wheels(_name(number), *map(round, self._wheels[number]))
        self.now += seconds

    def look(self) -> None:
        """At a picture of now."""
        start = time.process_time()
        picture = self._painter.picture(scene_of(self.world, "above", self.now, self.now))
        painted = time.process_time()
        self.tracker.see(self._detector.detect(picture[0].tobytes(), WIDTH, HEIGHT), (WIDTH, HEIGHT), self.now)
        self.painting, self.finding = painted - start, time.process_time() - painted

    def jpeg(self) -> bytes:
        """A picture of now, as the camera sends it."""
        return self._painter.jpeg(scene_of(self.world, "above", self.now, self.now))

    def play(self, seconds: float, chance: random.Random | None = None, rate: float = RATE) -> Iterator[None]:
        """Robots that drive at full speed as `chance` has it, if any; gives the time before each look: the places are
        then as old as they ever are."""
        commands = [STOP] * len(self._wheels)
        for _ in range(round(seconds * rate)):
            if chance:
                for number in range(len(commands)):
                    if chance.random() < 1.5 / rate:
                        commands[number] = chance.choice([(1, 0), (1, 0), (1, 1), (1, -1), (-1, 0), (0, 1), (0, -1)])
            self.drive(commands.__getitem__, 1 / rate)
            yield
            self.look()

    def seen(self) -> dict[int, Seen]:
        return {one.robot: one for one in self.tracker.robots(self.now)}

    def misses(self) -> dict[int, Miss]:
        """Of all robots that have a place."""
        return {number: self.miss(one) for number, one in self.seen().items()}

    def miss(self, seen: Seen) -> Miss:
        true = self.robot(seen.robot).pose
        distance = math.dist(true.point, seen.place.point)
        return Miss(distance, abs(math.degrees(wrap(seen.place.heading - true.heading))))


def _name(number: int) -> str:
    return f"virtual{number}"


def _speeds(linear_x: int, angular_z: int) -> tuple[float, float]:
    """Half-steps/s of the left and right wheel, as the firmware's movement table has them."""
    if linear_x == 0:
        return -SPEED * angular_z, -SPEED * angular_z
    left, right = -SPEED * linear_x, SPEED * linear_x
    return (left * CURVE if angular_z < 0 else left), (right * CURVE if angular_z > 0 else right)
