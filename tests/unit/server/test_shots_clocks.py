"""Three clocks count a cooldown: rosbridge's, the robot's and the referee's. No shot that a robot fires may be lost."""

from collections.abc import Iterable, Iterator
from random import Random

import pytest

from server.game.shooting import Shooting
from server.game.users import User
from server.rosbridge.shots import Shots
from tests.support.documents import value_of

COOLDOWN = round(value_of("firmware/laserbot/src/setup_msg.h: DEFAULT_COOLDOWN_MS"))  # ms, as all times here
GAP = round(value_of("firmware/laserbot/src/ir/emitter.h: GAP_MS"))
PACKET = round(value_of("firmware/laserbot/src/ir/packet.h: PACKET_MS"))
COMMANDS = 25  # from one command to the next
EVENING = 20_000
ON_THE_WAY = 60  # at most, of anything
STALL = range(10_200, 10_600)  # nothing reaches the robot

Command = tuple[int, int]  # when rosbridge passes it on, when the robot has it


class Robot:
    """As firmware/laserbot/src/ir/emitter.h."""

    def __init__(self) -> None:
        self.fired = -COOLDOWN
        self._wanted = False

    def shoot(self, now: int) -> None:
        self._wanted = self._wanted or now - self.fired >= COOLDOWN - GAP

    def update(self, now: int) -> bool:
        if not self._wanted or now - self.fired < COOLDOWN:
            return False
        self._wanted, self.fired = False, now
        return True


def taps(period: int) -> Iterator[int]:
    """The button is down for 80 ms each `period`."""
    for begin in range(0, EVENING, period):
        yield from range(begin, begin + 80, COMMANDS)


def arriving(sent: Iterable[int], jitter: Random, stall: range = range(0)) -> Iterator[Command]:
    last = 0
    for at in sent:
        arrives = at + jitter.randint(0, ON_THE_WAY)
        last = max(last, stall.stop if arrives in stall else arrives)  # TCP keeps the order
        yield at, last


def play(commands: Iterable[Command], way: Random) -> tuple[int, int]:
    """How many shots the robot has fired, all of them at another one, and how many of these the referee has counted."""
    passed_on: dict[int, int] = {}
    received: dict[int, int] = {}
    for sent, arrives in commands:
        passed_on[sent] = passed_on.get(sent, 0) + 1
        received[arrives] = received.get(arrives, 0) + 1
    bridge, robot, shooting = Shots(), Robot(), Shooting()
    ada, bob = (User(name, number, "", 0, 0.0) for number, name in enumerate(("ada", "bob")))
    told: list[int] = []
    reported: list[int] = []
    fired = counted = 0
    for now in range(EVENING + 1000):
        if now in passed_on and bridge.commanded("/Robot0/command", bytes([0, 0, 1]), True, now / 1000):
            told.append(now + way.randint(0, 10))
        for _ in range(received.get(now, 0)):
            robot.shoot(now)
        if robot.update(now):
            fired += 1
            reported.append(now + PACKET + way.randint(0, ON_THE_WAY))
        for _ in range(told.count(now)):
            shooting.fire(0, ada, now / 1000)
        for _ in range(reported.count(now)):
            counted += shooting.coded_hit(1, bob, 0, False, now / 1000) == "ada"
    return fired, counted


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("period", [400, 440, 460])
def test_no_shot_of_who_taps_is_lost(period: int, seed: int) -> None:
    fired, counted = play(((at, at) for at in taps(period)), Random(seed))
    assert fired >= EVENING / (2 * period)
    assert counted == fired


@pytest.mark.parametrize("seed", range(6))
def test_no_shot_of_a_held_trigger_is_lost_after_a_stall(seed: int) -> None:
    fired, counted = play(arriving(range(0, EVENING, COMMANDS), Random(seed), STALL), Random(seed))
    assert fired >= EVENING / COOLDOWN - 2
    assert counted == fired


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("period", [400, 440, 460])
def test_hardly_a_shot_of_who_taps_is_lost_on_a_restless_network(period: int, seed: int) -> None:
    fired, counted = play(arriving(taps(period), Random(seed)), Random(seed))
    assert counted >= fired - 1
