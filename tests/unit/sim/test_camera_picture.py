"""What is seen in a picture: who is where, how large, and what shines."""

import io
import math
import random
import re
from typing import Any

import numpy as np
import pytest
from PIL import Image

from sim.arena.ambient import Ambient
from sim.arena.cameras.colours import PALETTE, Colour, robot_colour
from sim.arena.cameras.optics import HEIGHT, WIDTH
from sim.arena.cameras.picture import Painter
from sim.arena.cameras.scene import Body, Room, Scene
from tests.support.floors import BATTLE_FLOOR
from tests.support.programs import ROOT

Picture = np.ndarray
OUTER = ((0, 0, 4, 0), (4, 0, 4, 2), (4, 2, 0, 2), (0, 2, 0, 0))
WALL = (2.0, 0.7, 2.0, 1.3)  # in the middle of the room
ME = Body("virtual9", 9, 1.2, 1.0, 0.0)  # looks along x, at the wall
MIDDLE = (HEIGHT // 2, WIDTH // 2)


@pytest.fixture(scope="module")
def painter() -> Painter:
    return Painter(Room(4, 2, (*OUTER, WALL), Ambient()))


def other(ahead: float, left: float = 0.0, number: int = 2, heading: float = math.pi, **state: Any) -> Body:
    """A robot so far (m) before ME, as seen from the robots' middles."""
    return Body(f"virtual{number}", number, ME.x + ahead, ME.y + left, heading, **state)


def see(painter: Painter, *others: Body, me: Body = ME, time: float = 0.0) -> Picture:
    """HEIGHT x WIDTH x 3, as numbers that may be subtracted."""
    return painter.picture(Scene(me.name, time, 0.0, (me, *others))).transpose(1, 2, 0).astype(int)


def coloured(picture: Picture, colour: Colour) -> Picture:
    """Where the picture has this hue, bright or dark."""
    pixels = picture - picture.mean(axis=2, keepdims=True)
    wanted = np.array(colour) - np.mean(colour)
    size = np.linalg.norm(pixels, axis=2)
    return (size > 25) & ((pixels @ wanted) > 0.94 * size * np.linalg.norm(wanted))


def changed(one: Picture, two: Picture) -> Picture:
    """Where they differ by more than anybody would overlook."""
    return np.abs(one - two).max(axis=2) > 12


def columns(mask: Picture) -> tuple[int, int]:
    """The first and the last column in which something is."""
    found = np.flatnonzero(mask.any(axis=0))
    return int(found[0]), int(found[-1])


@pytest.mark.parametrize("number", range(len(PALETTE)))
def test_a_robot_straight_ahead_is_in_the_middle_in_its_own_colour(painter: Painter, number: int) -> None:
    empty = see(painter)
    full = see(painter, other(0.35, number=number))
    assert changed(full, empty)[MIDDLE]
    painted = coloured(full, robot_colour(number)) & changed(full, empty)
    assert painted.sum() > 600
    left, right = columns(painted)
    assert abs((left + right) / 2 - MIDDLE[1]) < 25
    assert right - left < WIDTH * 0.6


def test_it_is_as_wide_as_its_distance_makes_it(painter: Painter) -> None:
    # the lens is 0.06 m ahead of the middle of its robot, the focal length is 160 pixels
    wide = changed(see(painter, other(0.66)), see(painter))[60:120]  # the turret, and no light on the floor
    left, right = columns(wide)
    assert right - left + 1 == pytest.approx(2 * 0.052 / 0.6 * 160, abs=4)


def test_left_is_left_and_right_is_right(painter: Painter) -> None:
    empty = see(painter)
    left = changed(see(painter, other(0.4, left=0.2)), empty)
    right = changed(see(painter, other(0.4, left=-0.2)), empty)
    assert columns(left)[1] < MIDDLE[1] < columns(right)[0]


def test_whoever_turns_left_sees_it_move_right(painter: Painter) -> None:
    places = []
    for heading in (-0.3, 0.0, 0.3):
        me = Body(ME.name, ME.id, ME.x, ME.y, heading)
        places.append(np.mean(columns(changed(see(painter, other(0.5), me=me), see(painter, me=me)))))
    assert places[0] < places[1] - 30 < places[2] - 60


def test_nearer_is_larger(painter: Painter) -> None:
    empty = see(painter)
    sizes = [changed(see(painter, other(ahead)), empty).sum() for ahead in (0.7, 0.5, 0.35, 0.2)]
    assert sizes == sorted(sizes)
    assert sizes[-1] > 4 * sizes[0]


@pytest.mark.parametrize("ahead", [-0.2, -0.5])
def test_what_is_behind_is_not_seen(painter: Painter, ahead: float) -> None:
    assert np.array_equal(see(painter, other(ahead)), see(painter))


def test_a_wall_hides_who_is_behind_it_and_nobody_before_it(painter: Painter) -> None:
    empty = see(painter)
    assert not changed(see(painter, other(1.1)), empty).any()
    assert changed(see(painter, other(0.7)), empty).any()


def test_a_robot_hides_who_is_behind_it(painter: Painter) -> None:
    near = see(painter, other(0.3))
    both = see(painter, other(0.3), other(0.62, number=4))
    assert not changed(both, near).any()


@pytest.mark.parametrize("places", [(2, 4), (4, 2)])
def test_the_order_in_which_robots_are_told_does_not_matter(painter: Painter, places: tuple[int, int]) -> None:
    bodies = {2: other(0.3, left=0.05), 4: other(0.5, number=4)}
    picture = see(painter, *(bodies[place] for place in places))
    assert np.array_equal(picture, see(painter, bodies[2], bodies[4]))


def test_its_number_is_on_it_from_all_sides(painter: Painter) -> None:
    for heading in np.linspace(0, math.tau, 7):
        one, nine = (see(painter, other(0.3, number=number, heading=heading)) for number in (2, 10))  # of one colour
        assert changed(one, nine).sum() > 30


def test_a_robot_without_a_number_is_seen_too(painter: Painter) -> None:
    guest = Body("guest", None, ME.x + 0.3, ME.y, 0.0)
    assert changed(see(painter, guest), see(painter))[MIDDLE]


def test_one_sees_which_way_it_looks(painter: Painter) -> None:
    there, away = (see(painter, other(0.3, heading=heading)) for heading in (math.pi, 0.0))
    assert changed(there, away).sum() > 300


def test_the_own_shot_goes_from_below_to_the_middle(painter: Painter) -> None:
    shooting = Body(ME.name, ME.id, ME.x, ME.y, ME.heading, beam=True, reach=0.7)
    light = see(painter, me=shooting) - see(painter)
    seen = light[..., 0] > 40
    left, right = columns(seen[MIDDLE[0] + 25 :])
    assert MIDDLE[1] - 30 < left < right < MIDDLE[1] + 30
    rows = np.flatnonzero(seen[:, MIDDLE[1]])
    assert MIDDLE[0] - 15 <= rows[0] <= MIDDLE[0] + 1
    assert rows[-1] > HEIGHT - 30
    assert set(range(MIDDLE[0] + 1, HEIGHT - 30)) <= set(map(int, rows))
    assert light[..., 0][seen].sum() > light[..., 1][seen].sum()  # it is pink


def test_the_shot_of_another_is_seen_where_it_passes(painter: Painter) -> None:
    # from the left to the right, 0.5 m ahead
    shooter = other(0.56, left=0.3, heading=-math.pi / 2)
    shooting = other(0.56, left=0.3, heading=-math.pi / 2, beam=True, reach=0.5)
    seen = changed(see(painter, shooting), see(painter, shooter))
    left, right = columns(seen)
    assert left < MIDDLE[1] - 40
    assert right > MIDDLE[1] + 40
    assert seen[MIDDLE[0] - 3 : MIDDLE[0] + 15, left + 10 : right - 20].any(axis=0).all()


def test_a_wall_hides_a_shot(painter: Painter) -> None:
    hidden = other(1.1, left=0.2, heading=-math.pi / 2, beam=True, reach=0.3)
    assert not changed(see(painter, hidden), see(painter)).any()


def test_a_robot_that_is_hit_lights_up(painter: Painter) -> None:
    before, after = see(painter, other(0.35)), see(painter, other(0.35, lit=True))
    body = changed(before, see(painter))
    assert (after - before)[..., 0][body].mean() > 30


def test_who_is_hit_sees_red_most_of_all_at_the_edges(painter: Painter) -> None:
    hit = Body(ME.name, ME.id, ME.x, ME.y, ME.heading, lit=True)
    red = (see(painter, me=hit) - see(painter))[..., 0]
    assert red[:20].mean() > 50
    assert red[:20].mean() > 3 * red[100:140, 140:180].mean()


@pytest.mark.parametrize("light", [Ambient(sun=True), Ambient(lamp=True)])
def test_one_sees_what_other_light_there_is(painter: Painter, light: Ambient) -> None:
    lit = Painter(Room(4, 2, (*OUTER, WALL), light))
    assert (see(lit) - see(painter))[: HEIGHT // 2].mean() > 3


def test_one_sees_a_remote_control_while_its_key_is_pressed() -> None:
    painter = Painter(Room(4, 2, (*OUTER, WALL), Ambient(remote=True)))
    me = Body(ME.name, ME.id, ME.x, ME.y, -math.pi / 3)
    assert changed(see(painter, me=me, time=7.1), see(painter, me=me, time=7.6)).any()
    assert np.array_equal(see(painter, me=me, time=7.1), see(painter, me=me, time=8.1))


def test_a_picture_is_a_small_jpeg(painter: Painter) -> None:
    jpeg = painter.jpeg(Scene(ME.name, 0.0, 0.0, (ME, other(0.3))))
    assert Image.open(io.BytesIO(jpeg)).size == (320, 240)
    assert len(jpeg) < 30_000


def test_what_looks_as_before_is_not_painted_again() -> None:
    painter = Painter(Room(4, 2, OUTER, Ambient()))

    def seen(taken: float, *others: Body) -> bytes:
        return painter.jpeg(Scene(ME.name, taken, taken, (ME, *others)))

    first = seen(1.0, other(0.3))
    painter.jpeg(Scene("virtual2", 1.0, 1.0, (ME, other(0.3))))  # another eye's
    assert seen(2.0, other(0.3)) is first
    assert seen(3.0, other(0.4)) != first


@pytest.mark.parametrize("room", [Room(4, 2, OUTER, Ambient(remote=True)), Room(4, 2, OUTER, Ambient(), timecode=True)])
def test_what_changes_by_itself_is_painted_again(room: Room) -> None:
    painter = Painter(room)
    me = Body("virtual9", 9, 2.0, 0.5, -math.pi / 2)  # looks at the one with the remote control
    assert painter.jpeg(Scene(me.name, 7.1, 7.1, (me,))) != painter.jpeg(Scene(me.name, 7.9, 7.9, (me,)))


def test_whatever_stands_wherever_there_is_a_picture() -> None:
    painter = Painter(Room(BATTLE_FLOOR.width, BATTLE_FLOOR.height, BATTLE_FLOOR.walls, Ambient()))
    chance = random.Random(1)
    for _ in range(150):
        robots = tuple(
            Body(
                f"virtual{number}", number, chance.uniform(0.075, 1.525), chance.uniform(0.075, 1.125),
                chance.uniform(-math.pi, math.pi), chance.random() < 0.5, chance.random() < 0.3, chance.uniform(0, 0.9),
            )
            for number in range(8)
        )  # fmt: skip
        assert painter.picture(Scene("virtual0", chance.uniform(0, 9), 0.0, robots)).shape == (3, HEIGHT, WIDTH)


def test_the_colours_are_those_of_the_arenas_page() -> None:
    page = re.search(r"COLOURS = \[(.*?)\]", (ROOT / "server/static/js/arena/colours.js").read_text())
    assert page
    assert tuple(re.findall(r'"(#\w+)"', page[1])) == PALETTE
