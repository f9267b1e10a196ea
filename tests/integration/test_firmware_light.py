"""The real firmware's light in the simulated Uno, in virtual time: packets out and in, and the wheels meanwhile."""

import itertools
from collections.abc import Iterator

import pytest

from tests.support.avr import CYCLES_PER_SECOND, RESPONSE_ID, command
from tests.support.documents import Row, page, table
from tests.support.virtual_time import CODED, HIT_ID, MS, PLAIN, Uno, lengths, setup, uno

PAGE = page("protocol-light.md")
PACKETS = table(PAGE, "Packets")
SEEN = table(PAGE, "Packets as a receiver sees them")
NONE = table(PAGE, "No packets")
SHOT = command(0, 0, shoot=True)
SEEN_BY_OTHERS = 100  # us that a mark or space may differ from the page's


@pytest.fixture
def robot() -> Iterator[Uno]:
    """Connected, in coded mode with the ID 99; the hits of others come through."""
    with uno() as robot:
        robot.run(0.02)
        robot.connect(setup(99))
        yield robot


def light_of(row: Row) -> list[int]:
    return [int(us) for us in row["light"].split()]


def hit_of(row: Row) -> bytes:
    return bytes([int(row["shooter"]), int(row["team"]), int(row["damage"])])


def hits(robot: Uno, since: int = 0) -> list[bytes]:
    return [payload for _, payload in robot.said(HIT_ID, since)]


@pytest.mark.parametrize("row", PACKETS, ids=lambda row: row["bits"])
def test_a_shot_is_the_packet_of_the_page(row: Row) -> None:
    with uno() as robot:
        robot.run(0.02)
        shooter, team, damage = hit_of(row)
        robot.connect(setup(shooter, team, CODED, damage=damage))
        robot.send(SHOT)
        robot.run(0.1)
        assert lengths(robot.carrier) == pytest.approx(light_of(row), abs=SEEN_BY_OTHERS)
        assert robot.beam == []


@pytest.mark.parametrize("row", PACKETS + SEEN, ids=lambda row: row["light"])
def test_a_packet_of_the_page_is_a_hit(row: Row) -> None:
    """The simulator's demodulating receiver would lengthen once more what a receiver has lengthened."""
    with uno(coded=row in PACKETS) as robot:
        robot.run(0.02)
        robot.connect(setup(99))
        robot.light(light_of(row))
        robot.run(0.06)
        assert hits(robot) == [hit_of(row)]


def test_what_is_no_packet_on_the_page_is_no_hit_and_a_packet_after_it_is_one(robot: Uno) -> None:
    for row in NONE:
        before = robot.now
        robot.light(light_of(row))
        robot.run(0.6)
        assert hits(robot, before) == [], row["what"]
        robot.light(light_of(PACKETS[1]))
        robot.run(0.06)
        assert hits(robot, before) == [hit_of(PACKETS[1])], row["what"]


def test_a_hit_is_told_soon_after_the_packets_end(robot: Uno) -> None:
    start = robot.now
    robot.light(light_of(PACKETS[2]))
    robot.run(0.06)
    ((told, _),) = robot.said(HIT_ID)
    end = start + 5 * MS + sum(light_of(PACKETS[2])) * MS // 1000  # the simulator's receiver sees it 5 ms later
    assert told - end <= 5 * MS


def test_the_own_id_and_repeats_of_a_shooter_are_no_hits() -> None:
    mine, other = PACKETS[2], PACKETS[3]
    with uno() as robot:
        robot.run(0.02)
        robot.connect(setup(int(mine["shooter"])))
        robot.light(light_of(mine))
        robot.run(0.06)
        assert hits(robot) == []
        for _ in range(8):
            robot.light(light_of(other))
            robot.run(0.05)
        assert hits(robot) == [hit_of(other)]
        robot.run(0.2)
        robot.light(light_of(other))
        robot.run(0.06)
        assert hits(robot) == [hit_of(other)] * 2


def test_light_is_ignored_while_the_robot_fires(robot: Uno) -> None:
    robot.light(light_of(PACKETS[2]))  # seen in 5 ms
    robot.run(0.004)
    robot.send(SHOT)
    robot.run(0.1)
    assert len(robot.carrier) > 0
    assert hits(robot) == []
    robot.light(light_of(PACKETS[3]))
    robot.run(0.1)
    assert hits(robot) == [hit_of(PACKETS[3])]


@pytest.mark.parametrize("cooldown", [500, 1000])
def test_a_held_trigger_sends_a_packet_each_cooldown(cooldown: int) -> None:
    with uno() as robot:
        robot.run(0.02)
        robot.connect(setup(5, cooldown=cooldown))
        robot.run(5 * cooldown / 1000 - 0.05, SHOT)
        starts = robot.carrier[:: len(light_of(PACKETS[0])) + 1]
        assert len(starts) == 5
        gaps = [(later - earlier) / MS for earlier, later in itertools.pairwise(starts)]
        assert all(cooldown - 1 <= gap <= cooldown + 3 for gap in gaps)


def test_the_mode_is_plain_until_a_setup_says_coded_and_may_change_back() -> None:
    with uno(coded=False) as robot:
        robot.run(0.02)
        robot.connect()
        robot.send(SHOT)
        robot.run(0.6)
        assert [on for _, on in robot.beam] == [True, False]
        assert robot.beam[1][0] - robot.beam[0][0] == pytest.approx(500 * MS, rel=0.01)
        assert robot.carrier == []
        robot.send(setup(5))
        robot.send(SHOT)
        robot.run(0.6)
        assert len(robot.beam) == 2
        assert len(robot.carrier) > 20
        edges = len(robot.carrier)
        robot.send(setup(5, mode=PLAIN))
        robot.send(SHOT)
        robot.run(0.6)
        assert len(robot.beam) == 4
        assert len(robot.carrier) == edges


def test_a_setup_that_makes_no_sense_changes_nothing(robot: Uno) -> None:
    for wrong in (setup(-1), setup(5, team=4), setup(5, mode=2), setup(5, damage=16), setup(5)[:-2]):
        robot.send(wrong)
        robot.run(0.03)
    robot.light(light_of(PACKETS[2]))
    robot.run(0.06)
    assert hits(robot) == [hit_of(PACKETS[2])]


def test_plain_light_is_a_hit_after_30_ms_and_the_own_light_is_none() -> None:
    with uno(coded=False) as robot:
        robot.run(0.02)
        robot.connect()
        start = robot.now
        robot.shine(True)
        robot.run(0.5)
        robot.shine(False)
        robot.run(0.1)
        ((told, _),) = robot.said(RESPONSE_ID)
        assert 29 * MS <= told - start <= 34 * MS
        robot.send(SHOT)
        robot.run(0.01)
        robot.shine(True)
        robot.run(0.48)
        robot.shine(False)
        robot.run(0.2)
        assert len(robot.said(RESPONSE_ID)) == 1


@pytest.mark.parametrize(("angular_z", "left", "right"), [(0, -1024, 1024), (-1, -716.8, 1024)])
def test_wheels_keep_their_speed_and_the_dead_man_its_time_under_light(
    angular_z: int, left: float, right: float
) -> None:
    """Packets of two shooters, a remote control and a flood of edges at the sensor, shots all the while."""
    with uno() as robot:
        robot.run(0.02)
        robot.connect(setup(99))
        moving = command(1, angular_z, shoot=True)
        robot.run(0.3, moving)
        before, start = (robot.position("left"), robot.position("right")), robot.now
        lights = [light_of(row) for row in (*PACKETS[2:4], NONE[-2])] + [[100, 90] * 150]
        for light in itertools.islice(itertools.cycle(lights), 40):
            robot.light(light)
            robot.run(0.05, moving)
        seconds = (robot.now - start) / CYCLES_PER_SECOND
        speeds = [(robot.position(wheel) - old) / seconds for wheel, old in zip(("left", "right"), before, strict=True)]
        assert speeds == pytest.approx([left, right], rel=0.01)
        robot.send(moving)
        last = robot.now
        robot.light([100, 90] * 150)
        robot.run(0.5)
        assert 310 <= (robot.steps[-1][0] - last) / MS <= 350
