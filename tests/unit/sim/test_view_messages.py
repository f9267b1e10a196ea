"""What viewers of the arena get."""

import json
import math

from laser_bot_battle.geometry import Pose
from sim.arena.view import arena_message, state_message
from sim.arena.world import World
from tests.support.floors import BATTLE_FLOOR


def test_the_first_message_describes_the_floor_and_the_beam() -> None:
    message = json.loads(json.dumps(arena_message(World(BATTLE_FLOOR))))
    assert (message["type"], message["width"], message["height"]) == ("arena", 1.6, 1.2)
    assert [0, 0, 1.6, 0] in message["walls"]
    assert (message["robot_radius"], message["beam_range"]) == (0.075, 0.9)
    assert math.degrees(message["beam_half_angle"]) == 8


def test_a_coded_shot_is_shown_for_as_long_as_eyes_need() -> None:
    world = World(BATTLE_FLOOR)
    world.arrive("a0").pose = Pose(0.3, 0.15, 0)
    world.arrive("b1").pose = Pose(0.7, 0.15, 0)
    world.set_carrier("a0", True, 0, now=100.0)
    world.set_carrier("a0", False, 38_400, now=100.002)

    def shown(now: float) -> list[tuple[bool, bool]]:
        return [(robot["beam"], robot["lit"]) for robot in state_message(world, now)["robots"]]

    assert shown(100.15) == [(True, False), (False, True)]
    assert shown(100.16) == [(False, False), (False, False)]


def test_a_state_shows_every_robot_in_the_order_of_names() -> None:
    world = World(BATTLE_FLOOR)
    world.arrive("virtual1")
    world.arrive("guest").pose = Pose(0.25, 0.75, 1.5)
    world.set_beam("guest", True)
    message = state_message(world, 112.3456, start=100.0)
    assert (message["type"], message["time"]) == ("state", 12.346)
    assert [robot["name"] for robot in message["robots"]] == ["guest", "virtual1"]
    assert message["robots"][0] == {
        "name": "guest", "id": None, "x": 0.25, "y": 0.75, "heading": 1.5, "beam": True, "lit": False, "hits": 0,
    }  # fmt: skip
