"""Coded light with the real firmware: robots in the arena shoot at one another, and what they report."""

import contextlib
import math
import struct
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.integration.sim.arena import HOST, Arena, Hardware
from tests.support.avr import CYCLES_PER_SECOND, AvrRobot, SerialHost, avr_robot, command, frame
from tests.support.polling import until

SETUP_ID, HIT_ID, BOARD_ID = 101, 126, 127
RESPONSE_ID = 125
TEAM, DAMAGE = 2, 9
PLAIN, CODED = 0, 1
ROW = 0.15  # m; the robots stand along the bottom wall


class Fighter:
    """A virtual robot behind its serial line."""

    def __init__(self, robot: AvrRobot, host: SerialHost, number: int) -> None:
        self.robot, self.host, self.number = robot, host, number
        host.negotiate()

    def set_up(self, mode: int) -> None:
        self.host.send(frame(SETUP_ID, struct.pack("<bBBHB", self.number, TEAM, mode, 500, DAMAGE)))
        until(lambda: self.boards()[-1:] and self.boards()[-1][5] == mode, 5, "the mode")

    def shoot(self) -> None:
        """The whole of a shot, and the cooldown after it."""
        before = len(self.robot.cycles_of("carrier", "0"))
        self.host.send(command(0, 0, shoot=True))
        until(lambda: len(self.robot.cycles_of("carrier", "0")) == before + 15, 5, "a packet")
        self.robot.let_pass(0.5)

    def hits(self) -> list[tuple[int, ...]]:
        """Shooter, team and damage of each."""
        return [tuple(frame.payload) for frame in self.host.frames if frame.topic_id == HIT_ID]

    def boards(self) -> list[bytes]:
        return [frame.payload for frame in self.host.frames if frame.topic_id == BOARD_ID]


def place_three(arena: Arena) -> None:
    """virtual2 in the middle; virtual0 and virtual1 on either side of it, who look at it."""
    with contextlib.ExitStack() as stack:
        stack.enter_context(Hardware(arena, "virtual2")).drive_to(0.8, ROW)
        for name in ("virtual0", "virtual1"):
            robot = stack.enter_context(Hardware(arena, name))
            until(lambda name=name: name in arena.look(), 5, name)
            x = robot.look()["x"]
            robot.drive_to(x, ROW)
            robot.drive_to(0.8 + math.copysign(0.35, x - 0.8), ROW)
            robot.face(math.pi if x > 0.8 else 0.0)
    until(lambda: not arena.look(), 5, "the places are remembered")


@pytest.fixture
def fighters(
    new_arena: Callable[..., Arena], tmp_path: Path
) -> Iterator[Callable[..., tuple[Arena, Fighter, Fighter, Fighter]]]:
    """An arena with these options, and three robots with such receivers in a mode: two shooters and their target."""
    with contextlib.ExitStack() as stack:

        def start(*options: str, receiver: str = "coded", mode: int = CODED) -> tuple[Arena, Fighter, Fighter, Fighter]:
            arena = new_arena(*options)
            place_three(arena)

            def fighter(number: int) -> Fighter:
                robot = stack.enter_context(
                    avr_robot(
                        *("--serial", tmp_path / f"tty{number}", "--receiver", receiver, "--supply", "4400"),
                        name=f"virtual{number}",
                        arena=f"{HOST}:{arena.link_port}",
                    )
                )
                fighter = Fighter(robot, stack.enter_context(contextlib.closing(SerialHost(robot.uart))), number)
                fighter.set_up(mode)
                return fighter

            one, other, target = fighter(0), fighter(1), fighter(2)
            until(lambda: len(arena.look()) == 3, 5, "all in the arena")
            return arena, one, other, target

        yield start


Start = Callable[..., tuple[Arena, Fighter, Fighter, Fighter]]


def test_a_shot_is_a_hit_that_says_whose(fighters: Start) -> None:
    arena, one, other, target = fighters()
    one.shoot()
    until(lambda: len(target.hits()) == 1, 5, "the hit")
    other.shoot()
    until(lambda: len(target.hits()) == 2, 5, "the next one")

    assert target.hits() == [(0, TEAM, DAMAGE), (1, TEAM, DAMAGE)]
    assert (one.hits(), other.hits()) == ([], [])
    seen = arena.look()
    assert [seen[f"virtual{n}"]["hits"] for n in range(3)] == [0, 0, 2]
    assert target.host.count(RESPONSE_ID) == 0


@pytest.mark.slow
def test_a_hit_is_on_the_serial_line_soon_after_the_packet(fighters: Start) -> None:
    _, one, _, target = fighters()
    one.shoot()
    until(lambda: len(target.hits()) == 1, 5, "the hit")

    ended = target.robot.cycles_of("light", "0")[-1]
    told = next(cycle for cycle in target.robot.cycles_of("uart-out") if cycle > ended + CYCLES_PER_SECOND // 1000)
    assert (told - ended) / CYCLES_PER_SECOND < 0.01


def test_two_shooters_at_once_are_never_mistaken_for_a_third(fighters: Start) -> None:
    _, one, other, target = fighters()
    for _ in range(5):
        one.host.send(command(0, 0, shoot=True))
        other.host.send(command(0, 0, shoot=True))
        target.robot.let_pass(0.6)
    together = len(target.hits())
    assert {hit[0] for hit in target.hits()} <= {0, 1}
    assert all(hit[1:] == (TEAM, DAMAGE) for hit in target.hits())
    one.shoot()
    until(lambda: len(target.hits()) == together + 1, 5, "a shot alone")
    assert target.hits()[-1] == (0, TEAM, DAMAGE)


@pytest.mark.parametrize(
    "source", ["--lamp", *(pytest.param(source, marks=pytest.mark.slow) for source in ("--sun", "--remote"))]
)
def test_other_light_is_no_hit_and_a_shot_counts_in_it(fighters: Start, source: str) -> None:
    _, one, _, target = fighters(source)
    target.robot.let_pass(2)
    assert target.hits() == []

    def is_hit() -> bool:  # a shot while the remote control sends is lost, as in reality
        one.shoot()
        return bool(target.hits())

    until(is_hit, 10, "a shot that counts")
    assert set(target.hits()) == {(0, TEAM, DAMAGE)}
    assert target.host.count(RESPONSE_ID) == 0


@pytest.mark.slow
def test_a_bare_phototransistor_in_other_light_is_not_fooled(fighters: Start) -> None:
    _, one, _, target = fighters("--lamp", "--remote", receiver="plain")
    target.robot.let_pass(3)
    one.shoot()
    assert target.hits() == []
    assert target.host.count(RESPONSE_ID) == 0


@pytest.mark.slow
def test_plain_mode_is_not_fooled_either(fighters: Start) -> None:
    _, one, _, target = fighters("--lamp", "--remote", receiver="plain", mode=PLAIN)
    target.robot.let_pass(3)
    assert target.host.count(RESPONSE_ID) == 0
    one.host.send(command(0, 0, shoot=True))
    until(lambda: target.host.count(RESPONSE_ID) == 1, 5, "a hit")
    assert target.hits() == []


@pytest.mark.slow
def test_the_board_tells_its_supply_and_that_it_has_no_battery(fighters: Start) -> None:
    _, one, _, _ = fighters()
    until(lambda: len(one.boards()) >= 3, 5, "some seconds")
    supply, battery = struct.unpack_from("<HH", one.boards()[-1], 11)
    assert supply == pytest.approx(4400, rel=0.01)
    assert battery == 0
