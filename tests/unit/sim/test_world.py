"""Robots on the floor: start positions, wheels, collisions, hits, and coming back."""

import math

import pytest

from laser_bot_battle.floor import Floor
from laser_bot_battle.geometry import METRES_PER_HALF_STEP, ROBOT_RADIUS, Pose, bearing, nearest_on_wall, wrap
from sim.arena.light import shines_on
from sim.arena.world import MAX_JUMP, MAX_REMEMBERED, MAX_ROBOTS, ArenaError, World
from tests.support.floors import BATTLE_FLOOR, DUEL_FLOOR

EMPTY_FLOOR = Floor.of(2.0, 2.0, (), ((1.0, 1.0), (0.2, 0.2), (1.8, 1.8)))


def world_with(*poses: Pose, floor: Floor = EMPTY_FLOOR) -> World:
    """Robots a, b, c ... at these poses, their wheels' baseline 0."""
    world = World(floor)
    for name, pose in zip("abcdefgh", poses, strict=False):
        world.arrive(name).pose = pose
        world.turn_wheels(name, 0, 0)
    return world


def steps(metres: float) -> int:
    return round(metres / METRES_PER_HALF_STEP)


def drive(world: World, name: str, metres: float) -> None:
    """Forward, as the firmware does: left wheel negative, right wheel positive."""
    left, right = world.robots[name].wheels or (0, 0)
    world.turn_wheels(name, left - steps(metres), right + steps(metres))


def test_forward_is_left_negative_and_right_positive() -> None:
    world = world_with(Pose(1, 1, 0))
    world.turn_wheels("a", -steps(0.3), steps(0.3))
    assert world.robots["a"].pose.point == pytest.approx((1.3, 1.0), abs=1e-4)


def test_both_wheels_negative_turn_clockwise() -> None:
    world = world_with(Pose(1, 1, 0))
    world.turn_wheels("a", -320, -320)
    assert world.robots["a"].pose.heading < 0
    assert world.robots["a"].pose.point == pytest.approx((1, 1))


def test_the_first_report_of_the_wheels_is_the_baseline() -> None:
    world = World(EMPTY_FLOOR)
    start = world.arrive("a").pose
    world.turn_wheels("a", -90_000_000, 123)
    assert world.robots["a"].pose == start


def test_no_wheel_jumps() -> None:
    world = world_with(Pose(1, 1, 0))
    with pytest.raises(ArenaError, match="cannot turn"):
        world.turn_wheels("a", 0, MAX_JUMP + 1)
    assert world.robots["a"].pose == Pose(1, 1, 0)


def test_a_wall_stops_a_robot() -> None:
    world = world_with(Pose(1, 1, 0))
    drive(world, "a", 1.2)
    assert world.robots["a"].pose.point == pytest.approx((2 - ROBOT_RADIUS, 1), abs=1e-3)


def test_a_robot_leaves_a_wall_backwards() -> None:
    world = world_with(Pose(1, 1, 0))
    drive(world, "a", 1.2)
    drive(world, "a", -0.4)
    assert world.robots["a"].pose.x == pytest.approx(2 - ROBOT_RADIUS - 0.4, abs=1e-3)


def test_a_robot_slides_along_a_wall() -> None:
    world = world_with(Pose(1.8, 1, math.radians(45)))
    drive(world, "a", 0.5)
    pose = world.robots["a"].pose
    assert pose.x == pytest.approx(2 - ROBOT_RADIUS, abs=1e-3)
    assert pose.y > 1.2


def test_a_corner_holds_a_robot() -> None:
    world = world_with(Pose(1.8, 1.8, math.radians(40)))
    drive(world, "a", 1.0)
    assert world.robots["a"].pose.point == pytest.approx((2 - ROBOT_RADIUS, 2 - ROBOT_RADIUS), abs=0.01)


def test_robots_do_not_pass_through_each_other() -> None:
    world = world_with(Pose(0.5, 1, 0), Pose(1, 1, math.pi))
    drive(world, "a", 1.0)
    assert world.robots["a"].pose.point == pytest.approx((1 - 2 * ROBOT_RADIUS, 1), abs=1e-3)
    assert world.robots["b"].pose == Pose(1, 1, math.pi)


def test_a_wedged_robot_stays_where_it_is() -> None:
    world = world_with(Pose(1.925, 1, 0), Pose(1.925, 1.15, 0), Pose(1.925, 0.85, 0))
    drive(world, "a", 0.5)
    assert world.robots["a"].pose.point == pytest.approx((1.925, 1))


@pytest.mark.parametrize("floor", [BATTLE_FLOOR, DUEL_FLOOR], ids=["battle", "duel"])
def test_wherever_robots_drive_nothing_overlaps(floor: Floor) -> None:
    world = World(floor)
    names = [f"virtual{n}" for n in range(MAX_ROBOTS)]
    wheels = dict.fromkeys(names, (0, 0))
    for name in names:
        world.arrive(name)
        world.turn_wheels(name, 0, 0)
    for moment in range(400):
        for n, name in enumerate(names):
            left, right = wheels[name]
            wheels[name] = (left - 400 - 60 * n, right + 900 - 70 * ((moment // 50 + n) % 9))
            world.turn_wheels(name, *wheels[name])
    points = [robot.pose.point for robot in world.robots.values()]
    for n, point in enumerate(points):
        assert all(math.dist(point, nearest_on_wall(point, wall)) > ROBOT_RADIUS - 1e-4 for wall in floor.walls)
        assert all(math.dist(point, other) > 2 * ROBOT_RADIUS - 1e-4 for other in points[:n])
        assert 0 < point[0] < floor.width and 0 < point[1] < floor.height


def test_in_a_duel_each_two_robots_have_each_other_in_their_beams_from_the_start() -> None:
    starts = [Pose(*start) for start in DUEL_FLOOR.starts]
    for one, other in zip(starts[::2], starts[1::2], strict=True):
        others = [pose.point for pose in starts if pose not in (one, other)]
        assert shines_on(one, other.point, DUEL_FLOOR.walls, others)
        assert shines_on(other, one.point, DUEL_FLOOR.walls, others)


def test_a_beam_lights_the_other_robot_only() -> None:
    world = world_with(Pose(0.5, 1, 0), Pose(1, 1, math.pi))
    world.set_beam("a", True)
    assert [robot.name for robot in world.update_light()] == ["b"]
    assert world.robots["b"].lit and not world.robots["a"].lit


def test_light_that_stays_is_one_hit() -> None:
    world = world_with(Pose(0.5, 1, 0), Pose(1, 1, math.pi))
    world.set_beam("a", True)
    world.update_light()
    assert world.update_light() == []
    world.set_beam("a", False)
    assert [robot.lit for robot in world.update_light()] == [False]
    world.set_beam("a", True)
    world.update_light()
    assert world.robots["b"].hits == 2


def test_a_robot_that_drives_into_the_light_is_hit() -> None:
    world = world_with(Pose(0.5, 1, 0), Pose(1, 0.7, math.pi / 2))
    world.set_beam("a", True)
    assert world.update_light() == []
    drive(world, "b", 0.25)
    assert [robot.name for robot in world.update_light()] == ["b"]


def test_a_shooter_that_leaves_takes_its_light_along() -> None:
    world = world_with(Pose(0.5, 1, 0), Pose(1, 1, math.pi))
    world.set_beam("a", True)
    world.update_light()
    world.leave("a")
    assert [(robot.name, robot.lit) for robot in world.update_light()] == [("b", False)]


def test_robots_start_apart_and_face_the_centre() -> None:
    world = World(BATTLE_FLOOR)
    robots = [world.arrive(f"virtual{n}") for n in range(MAX_ROBOTS)]
    assert len({robot.pose for robot in robots}) == MAX_ROBOTS
    for robot in robots:
        assert abs(wrap(bearing(robot.pose.point, (0.8, 0.6)) - robot.pose.heading)) < 1e-9
    assert math.dist(robots[0].pose.point, robots[1].pose.point) > 1.4


def test_the_floor_is_the_same_from_both_ends() -> None:
    def turned(x: float, y: float) -> tuple[float, float]:
        return round(BATTLE_FLOOR.width - x, 6), round(BATTLE_FLOOR.height - y, 6)

    walls = {frozenset({(round(x1, 6), round(y1, 6)), (round(x2, 6), round(y2, 6))})
             for x1, y1, x2, y2 in BATTLE_FLOOR.walls}  # fmt: skip
    assert walls == {frozenset({turned(x1, y1), turned(x2, y2)}) for x1, y1, x2, y2 in BATTLE_FLOOR.walls}


def test_no_robot_starts_upon_another() -> None:
    world = World(Floor.of(2.0, 2.0, (), ((1.0, 1.0),)))
    world.arrive("a")
    with pytest.raises(ArenaError, match="robots stand on all 1 start places"):
        world.arrive("b")
    world.robots["a"].pose = Pose(1.3, 1.0, 0)
    assert world.arrive("b").pose.point == (1.0, 1.0)


def test_a_ninth_robot_finds_the_floor_full() -> None:
    world = World(BATTLE_FLOOR)
    for n in range(MAX_ROBOTS):
        world.arrive(f"virtual{n}")
    with pytest.raises(ArenaError, match="full"):
        world.arrive("virtual8")


def test_a_robot_that_returns_gets_its_place_and_hits_back() -> None:
    world = world_with(Pose(0.5, 1, 0), Pose(1, 1, math.pi))
    world.set_beam("a", True)
    world.update_light()
    world.leave("b")
    robot = world.arrive("b")
    assert (robot.pose, robot.hits, robot.wheels) == (Pose(1, 1, math.pi), 1, None)


def test_a_robot_whose_place_is_taken_starts_anew() -> None:
    world = world_with(Pose(0.5, 1, 0), Pose(1, 1, math.pi))
    world.leave("b")
    drive(world, "a", 0.45)
    assert world.arrive("b").pose in [Pose(*start) for start in EMPTY_FLOOR.starts]


def test_not_every_robot_is_remembered_for_ever() -> None:
    world = World(EMPTY_FLOOR)
    for n in range(MAX_REMEMBERED + 1):
        world.arrive(f"r{n}").hits = 5
        world.leave(f"r{n}")
    assert world.arrive("r0").hits == 0
    assert world.arrive(f"r{MAX_REMEMBERED}").hits == 5


@pytest.mark.parametrize(("name", "number"), [("virtual0", 0), ("robot-17", 17), ("b2b", None)])
def test_the_id_is_the_number_at_the_end_of_the_name(name: str, number: int | None) -> None:
    assert World(EMPTY_FLOOR).arrive(name).id == number
