"""Which commands are told to the referee as shots."""

from itertools import pairwise
from typing import Any

import pytest

from laser_bot_battle.light_protocol import COOLDOWN, PLAIN_PERIOD
from laser_bot_battle.msg import GameStatus, UserStatus
from laser_bot_battle.names import session_digest
from server.access.identity import Identity, session_identity
from server.rosbridge.effects import Publish
from server.rosbridge.shots import Shots
from tests.unit.rosbridge.clients import TOKEN, Server, error, say

SHOOT, DRIVE = bytes([1, 0, 1]), bytes([1, 0, 0])
SHOOTING: dict[str, Any] = {
    "op": "publish",
    "topic": "/Robot3/command",
    "msg": {"linear_x": 0, "angular_z": 0, "shoot": True},
}


def times(shots: Shots, command: bytes, period: float, seconds: float, coded: bool = True) -> list[float]:
    """When a shot is told, while `command` comes every `period` s."""
    moments = [number * period for number in range(round(seconds / period))]
    return [now for now in moments if shots.commanded("/Robot3/command", command, coded, now)]


def test_a_held_trigger_is_a_shot_each_cooldown() -> None:
    told = times(Shots(), SHOOT, period=0.025, seconds=10)
    assert len(told) in (20, 21)
    assert all(later - earlier >= COOLDOWN - 0.06 for earlier, later in pairwise(told))


def test_plain_light_is_a_shot_each_pulse_and_the_darkness_after_it() -> None:
    told = times(Shots(), SHOOT, period=0.025, seconds=11, coded=False)
    assert len(told) in (20, 21)
    assert all(later - earlier >= PLAIN_PERIOD - 0.06 for earlier, later in pairwise(told))


@pytest.mark.parametrize("period", [0.02, 0.024, 0.033, 0.05, 0.11])
def test_each_shot_is_told_before_the_robot_can_fire_it(period: float) -> None:
    """A robot fires on the first command after its cooldown."""
    told = times(Shots(), SHOOT, period, seconds=20)
    fires, now = [], -COOLDOWN
    for number in range(round(20 / period)):
        if number * period - now >= COOLDOWN:
            now = number * period
            fires.append(now)
    assert abs(len(told) - len(fires)) <= 0.1 * len(fires)
    for fire in fires:
        assert any(-1e-9 <= fire - shot <= COOLDOWN for shot in told)


def test_what_only_moves_is_no_shot() -> None:
    assert times(Shots(), DRIVE, period=0.025, seconds=2) == []


def test_each_robot_has_its_own_cooldown() -> None:
    shots = Shots()
    assert shots.commanded("/Robot0/command", SHOOT, True, 5.0) == [Publish("/shots", b"\x00")]
    assert shots.commanded("/Robot127/command", SHOOT, True, 5.0) == [Publish("/shots", b"\x7f")]
    assert shots.commanded("/Robot0/command", SHOOT, True, 5.1) == []


def test_commands_that_go_through_are_told_and_others_are_not() -> None:
    server = Server()
    server.battle()
    al, operator, guest = server.client(session_identity(TOKEN)), server.client(), server.client(Identity())
    assert error(say(guest, 0.0, **SHOOTING))
    assert Publish("/shots", b"\x03") in say(al, 0.0, **SHOOTING)
    assert not [each for each in say(al, 0.1, **SHOOTING) if each == Publish("/shots", b"\x03")]
    assert Publish("/shots", b"\x03") in say(operator, 1.0, **SHOOTING), "a test drive"
    server.battle(game=0)
    assert error(say(al, 2.0, **SHOOTING))


@pytest.mark.parametrize(("coded", "told"), [(True, True), (False, False)])
def test_the_referee_says_by_which_light_shots_are_counted(coded: bool, told: bool) -> None:
    server = Server()
    server.battle(coded=coded)
    al = server.client(session_identity(TOKEN))
    say(al, 0.0, **SHOOTING)
    assert (Publish("/shots", b"\x03") in say(al, 0.45, **SHOOTING)) == told


def test_who_practises_beside_a_battle_drives_without_shooting() -> None:
    server = Server()
    al = UserStatus(name="al", robot=3, life=100, session=session_digest(TOKEN))
    server.gate.update(GameStatus(game=GameStatus.PLAYING, users=[al], practice_beside=True), 0.0)
    command = {**SHOOTING, "msg": {"linear_x": 1, "angular_z": 0, "shoot": True}}
    effects = say(server.client(session_identity(TOKEN)), 0.0, **command)
    assert [each.data for each in effects if isinstance(each, Publish)] == [DRIVE]
