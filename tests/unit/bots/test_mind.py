"""How the bot plays. Duels run in simulated time."""

import math
import random
from itertools import pairwise

import pytest

from laser_bot_battle.floor import Floor
from laser_bot_battle.geometry import Point, Pose, Wall, bearing
from server.bots.mind import NEUTRAL, SKILLS, Command, Mind, Skill
from server.bots.paths import Paths
from tests.support.floors import BATTLE_FLOOR
from tests.unit.bots.duel import TICK, Duel, Player, bot, idle

STEADY = Skill(mercy=0.0, reaction=0.2, aim_error=0.0, reload=(1.5, 1.5), rest=(0.1, 0.1), roam_chance=0.0)
LATER = 1.0  # s after the first look: more than any reaction time


def mind(skill: Skill = STEADY, walls: tuple[Wall, ...] = ()) -> Mind:
    floor = Floor.of(2.0, 2.0, walls, ((1.0, 1.0),))
    return Mind(Paths(2.0, 2.0, floor.walls), random.Random(1), skill)


def decide(player: Mind, me: Pose, *others: Point, opponents: set[int] | None = None) -> Command:
    """The command once the bot has seen this for long enough."""
    robots = dict(enumerate(others))
    player.decide(0.0, me, robots, opponents or set(robots))
    return player.decide(LATER, me, robots, opponents or set(robots))


@pytest.mark.parametrize(("y", "angular"), [(1.5, -1), (0.5, 1)], ids=["left", "right"])
def test_it_turns_towards_an_opponent(y: float, angular: int) -> None:
    assert decide(mind(), Pose(1, 1, 0), (1, y)) == Command(0, angular, False)


def test_it_shoots_when_aligned() -> None:
    assert decide(mind(), Pose(1, 1, 0), (1.5, 1)) == Command(0, 0, True)


def test_it_holds_its_fire_at_the_start_of_a_battle() -> None:
    player = mind(Skill(mercy=3.0, aim_error=0.0))
    me, opponent = Pose(1, 1, 0), {0: (1.3, 1.0)}
    shots = [now / 10 for now in range(0, 60) if player.decide(now / 10, me, opponent, {0}).shoot]
    assert shots[0] == 3.0


def test_it_does_not_shoot_while_nobody_can_be_hit() -> None:
    player = mind(Skill(mercy=1.0, aim_error=0.0))
    me, opponent = Pose(1, 1, 0), {0: (1.3, 1.0)}
    moments = [number / 10 for number in range(60)]
    shots = [now for now in moments if player.decide(now, me, opponent, {0}, protection=max(0.0, 3 - now)).shoot]
    assert 3.0 <= shots[0] <= 3.1


def test_it_drives_towards_an_opponent_out_of_range() -> None:
    assert decide(mind(), Pose(0.2, 1, 0), (1.7, 1)) == Command(1, 0, False)


def test_it_chooses_the_nearest_opponent() -> None:
    assert decide(mind(), Pose(1, 1, 0), (1, 1.6), (1, 0.5)).angular_z == 1


def test_it_leaves_alone_who_is_no_opponent() -> None:
    assert decide(mind(), Pose(1, 1, 0), (1, 1.6), (1, 0.5), opponents={0}).angular_z == -1


def test_without_opponents_it_stands_still() -> None:
    assert decide(mind(), Pose(1, 1, 0)) == NEUTRAL


def test_it_never_shoots_at_a_wall_in_between() -> None:
    player = mind(walls=((1.25, 0.6, 1.25, 1.4),))
    me, opponent = Pose(1, 1, 0), {0: (1.5, 1.0)}
    commands = [player.decide(n * TICK, me, opponent, {0}) for n in range(200)]
    assert not any(command.shoot for command in commands)
    assert any(command.linear_x or command.angular_z for command in commands)


def test_it_does_not_shoot_at_somebody_else_in_between() -> None:
    assert not decide(mind(), Pose(0.8, 1, 0), (1.4, 1), (1.1, 1), opponents={0}).shoot


def test_it_sees_others_only_after_its_reaction_time() -> None:
    player = mind(Skill(reaction=0.4))
    me, opponent = Pose(1, 1, 0), {0: (1.0, 1.5)}
    late = [n * TICK for n in range(30) if player.decide(n * TICK, me, opponent, {0}) != NEUTRAL]
    assert late[0] == pytest.approx(0.4, abs=TICK)


def test_it_aims_where_an_opponent_was() -> None:
    player = mind(Skill(reaction=0.4))
    me = Pose(1, 1, 0)
    for n in range(11):
        player.decide(n * TICK, me, {0: (1.0, 1.5)}, {0})
    assert player.decide(11 * TICK, me, {0: (1.0, 0.5)}, {0}).angular_z == -1  # it has just gone to the other side


def test_it_fires_at_most_once_in_one_and_a_half_seconds() -> None:
    duel = Duel({0: idle, 1: bot(seed=3)})
    duel.place(0, Pose(0.5, 0.2, 0))
    duel.place(1, Pose(0.9, 0.2, math.pi))
    duel.run(60)
    shots = duel.shots[1]
    assert len(shots) > 8
    assert min(later - sooner for sooner, later in pairwise(shots)) >= 1.5


def test_it_backs_off_when_it_is_stuck() -> None:
    player = mind()
    me, opponent = Pose(0.2, 1, 0), {0: (1.7, 1.0)}
    commands = [player.decide(n * TICK, me, opponent, {0}) for n in range(50)]
    assert any(command.linear_x == -1 and command.angular_z for command in commands)


def test_two_robots_that_block_each_other_get_free() -> None:
    duel = Duel({0: idle, 1: bot(seed=2)})
    duel.place(0, Pose(0.69, 0.45, 0))  # idle in the narrow way between two walls ...
    duel.place(1, Pose(0.69, 0.29, math.pi / 2))
    assert duel.run(240, until=lambda: duel.hits(0) >= 10) < 240


def test_it_leaves_alone_for_a_while_who_was_hit() -> None:
    player = mind(Skill(mercy=0.0, aim_error=0.0, spare=5.0))
    me, opponent = Pose(1, 1, 0), {0: (1.3, 1.0)}
    shots = [now / 10 for now in range(0, 90) if player.decide(now / 10, me, opponent, {0}, {0: 1.0}).shoot]
    assert not [at for at in shots if 1.1 < at < 6.0]
    assert max(shots) >= 6.0


def test_it_turns_to_another_than_who_was_hit() -> None:
    player = mind(Skill(aim_error=0.0, spare=5.0))
    me, others = Pose(1, 1, 0), {0: (1.0, 0.6), 1: (1.0, 1.5)}
    player.decide(0.0, me, others, set(others))
    assert player.decide(LATER, me, others, set(others), {0: LATER}).angular_z == -1


def hunter(seed: int, hit_at: dict[int, float]) -> Player:
    """An easy bot that fights robot 0 only."""
    floor = BATTLE_FLOOR
    player = Mind(Paths(floor.width, floor.height, floor.walls), random.Random(seed), SKILLS["easy"])
    return lambda now, me, others: player.decide(now, me, others, {0}, hit_at)


@pytest.mark.parametrize("seed", range(2))
def test_two_easy_bots_need_more_than_a_minute_for_somebody_who_does_nothing(seed: int) -> None:
    hit_at: dict[int, float] = {}
    duel = Duel({0: idle, 1: hunter(seed, hit_at), 2: hunter(seed + 10, hit_at)})
    hits = 0

    def is_out() -> bool:
        nonlocal hits
        if duel.hits(0) > hits:
            hits, hit_at[0] = duel.hits(0), duel.now
        return hits >= 10

    assert 72 < duel.run(400, until=is_out) < 400


@pytest.mark.parametrize("seed", range(4))
def test_somebody_who_does_nothing_is_beaten_but_not_at_once(seed: int) -> None:
    duel = Duel({0: idle, 1: bot(seed)})
    assert 40 < duel.run(150, until=lambda: duel.hits(0) >= 10) < 150


def test_a_quick_and_steady_player_wins_often() -> None:
    won = 0
    for seed in range(5):
        duel = Duel({0: bot(100 + seed, SKILLS["hard"]), 1: bot(seed)})
        duel.run(200, until=lambda duel=duel: max(duel.hits(0), duel.hits(1)) >= 10)
        won += duel.hits(1) > duel.hits(0)
    assert won >= 3


def test_it_finds_an_opponent_behind_walls() -> None:
    duel = Duel({0: idle, 1: bot(seed=5)})
    duel.place(0, Pose(0.48, 0.50, 0))  # inside the corner
    duel.place(1, Pose(0.17, 0.17, bearing((0.17, 0.17), (BATTLE_FLOOR.width, 0))))
    assert duel.run(60, until=lambda: duel.hits(0) >= 1) < 60
