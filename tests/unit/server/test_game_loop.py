"""The battle under many threads: nothing happens twice, listeners hear everything in order."""

import itertools
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from server.game.loop import GameLoop
from server.game.referee import Referee, Verdict
from server.game.robot import HIT_INTERVAL
from server.game.rules import Rules
from server.game.snapshot import Snapshot
from tests.support.linked import add_linked_robot
from tests.support.polling import until


@pytest.fixture
def battle() -> GameLoop:
    return GameLoop(Referee(Rules(robot_timeout=1000.0)))  # on a busy machine, no robot falls silent either


@pytest.fixture
def run(battle) -> Iterator[Callable[[], None]]:
    """Start the battle's thread; it must be gone after the test."""
    yield battle.start
    battle.stop()
    assert "game loop" not in [thread.name for thread in threading.enumerate()]


def at_once(number: int, act: Callable[..., Any]) -> list[Any]:
    """Call `act(0)` ... `act(number - 1)` from threads of their own at the same instant; the results in order."""
    barrier = threading.Barrier(number)
    results: list[Any] = [None] * number

    def run_one(index: int) -> None:
        barrier.wait()
        results[index] = act(index)

    threads = [threading.Thread(target=run_one, args=(index,)) for index in range(number)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return results


def test_one_name_claimed_by_many_at_the_same_instant_goes_to_exactly_one(battle):
    for number in range(16):
        add_linked_robot(battle, f"/r{number}")
    for turn in range(30):
        name = f"ada{turn}"
        verdicts = [verdict for verdict, _ in at_once(8, lambda index, name=name: battle.sign_up(name, f"s{index}", 0))]
        assert sorted(verdict.name for verdict in verdicts) == ["NAME_TAKEN"] * 7 + ["OK"]
        owner = verdicts.index(Verdict.OK)
        assert [player.session for player in battle.snapshot().players] == [f"s{owner}"]
        assert battle.snapshot().available_robots == 15
        assert battle.sign_out(name, f"s{owner}") is Verdict.OK


def test_robots_that_register_at_the_same_instant_get_different_ids(battle):
    ids = at_once(32, lambda index: battle.add_robot("/unnamed"))
    assert sorted(ids) == list(range(32))


def test_players_who_sign_up_at_the_same_instant_get_different_robots(battle):
    for _ in range(10):
        add_linked_robot(battle)
    answers = at_once(16, lambda index: battle.sign_up(f"p{index}", f"s{index}", 0))
    robots = [player.robot for verdict, player in answers if verdict is Verdict.OK]
    assert sorted(robots) == list(range(10))
    assert [verdict for verdict, _ in answers].count(Verdict.NO_ROBOTS) == 6


def test_a_snapshot_is_never_empty_while_players_are_signed_in_and_hit():
    patient = Rules(hit_damage=1, countdown=20, battle_limit=1e6, protection=0, player_timeout=1e6, robot_timeout=1e6)
    ticks = itertools.count()
    battle = GameLoop(Referee(patient), clock=lambda: next(ticks) * HIT_INTERVAL)
    for index in range(4):
        add_linked_robot(battle)
        battle.sign_up(f"p{index}", f"s{index}", 0)
        battle.set_ready(f"p{index}", True, f"s{index}")
    until(lambda: battle.snapshot().game == 2)

    def act(index: int) -> bool:
        if index < 4:
            return sum(battle.hit(index) for _ in range(90)) == 90
        return all(len(battle.snapshot().players) == 4 for _ in range(500))

    assert all(at_once(8, act))
    assert [player.life for player in battle.snapshot().players] == [10] * 4


def test_listeners_hear_every_change_in_order(battle, run):
    heard: list[tuple[int, ...]] = []
    battle.add_listener(lambda snapshot: heard.append(snapshot.robots))
    run()
    for _ in range(20):
        add_linked_robot(battle)
    until(lambda: heard and len(heard[-1]) == 20)
    changes = [robots for index, robots in enumerate(heard) if index == 0 or robots != heard[index - 1]]
    assert changes == [tuple(range(count + 1)) for count in range(20)]


def test_listeners_hear_a_heartbeat_without_any_change(battle, run):
    heard: list[Snapshot] = []
    battle.add_listener(heard.append)
    run()
    until(lambda: len(heard) >= 2, 3)


def test_listeners_are_called_without_the_lock(battle, run):
    seen = threading.Event()

    def look() -> None:
        battle.snapshot()
        seen.set()

    def listener(_):
        thread = threading.Thread(target=look)
        thread.start()
        thread.join(5)

    battle.add_listener(listener)
    run()
    add_linked_robot(battle)
    assert seen.wait(5)


def test_a_failing_listener_harms_neither_the_others_nor_the_game(battle, run, caplog):
    heard: list[Snapshot] = []

    def broken(_):
        raise RuntimeError("listener is broken")

    battle.add_listener(broken)
    battle.add_listener(heard.append)
    run()
    add_linked_robot(battle)
    until(lambda: heard and heard[-1].robots == (0,))
    assert "listener is broken" in caplog.text


def test_when_the_server_itself_stood_still_nobody_is_taken_for_gone():
    now = [100.0]
    battle = GameLoop(Referee(Rules(robot_timeout=3.0, player_timeout=15.0)), clock=lambda: now[0])
    battle.start()
    try:
        add_linked_robot(battle, "/a")
        battle.sign_up("al", "s", 0)
        now[0] += 60.0
        assert [player.name for player in battle.snapshot().players] == ["al"]
        assert battle.robot_alive(0)
        for _ in range(12):  # from here on the robot is silent while the server works
            now[0] += 0.3
            battle.snapshot()
        assert battle.snapshot().robots == ()
    finally:
        battle.stop()


def test_a_deadline_is_met_without_any_event():
    battle = GameLoop(Referee(Rules(countdown=0.1)))
    add_linked_robot(battle, "/a")
    add_linked_robot(battle, "/b")
    started = threading.Event()
    battle.add_listener(lambda snapshot: started.set() if snapshot.game == 2 else None)
    battle.start()
    try:
        for name in ("ada", "bob"):
            battle.sign_up(name, name, 0)
            battle.set_ready(name, True, name)
        began = time.monotonic()
        assert started.wait(5)
        assert time.monotonic() - began >= 0.05
    finally:
        battle.stop()


def test_what_happens_is_logged(battle, run, caplog):
    caplog.set_level("INFO")
    run()
    add_linked_robot(battle)
    until(lambda: "robot 0 registered by an unnamed client" in caplog.text)


def test_nobody_who_listens_waits_for_what_is_recorded(battle, run):
    told: list[str] = []
    battle.add_recorder(lambda journal, _: told.append(f"recorded {len(journal)}"))
    battle.add_listener(lambda snapshot: told.append(f"{len(snapshot.players)} players"))
    add_linked_robot(battle)
    battle.sign_up("ada", "s", 0)
    run()
    until(lambda: any(each.startswith("recorded") for each in told))
    first = next(place for place, each in enumerate(told) if each.startswith("recorded"))
    assert "1 players" in told[:first]
