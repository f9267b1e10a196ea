"""Where the entrance leads newcomers, and what it believes of what arenas say. The time is an argument."""

import json

import pytest

from laser_bot_battle.arena_list import ListedArena, read_arenas
from laser_bot_battle.names import Game
from laser_bot_battle.settings import SettingsError
from server.entrance.arenas import ARRIVES_WITHIN, DOUBTED, FRESH, LOST, Arenas
from server.entrance.seen import Seen, read_seen
from server.entrance.settings import Settings


def seen(free=0, players=(), waiting=(), game=Game.STOPPED, tournament=False):
    names = frozenset((*players, *waiting))
    return Seen(game, free, len(players), len(waiting), tournament, names)


class Hall:
    """An entrance to red, green and blue, at a time that stands still until it is set."""

    def __init__(self, **arenas: Seen) -> None:
        self.now = 1000.0
        self.arenas = Arenas(read_arenas("red=:1 green=:2 blue=:3"))
        self.hear(**arenas)

    def hear(self, **arenas: Seen) -> None:
        for name, state in arenas.items():
            self.arenas.hear(name, state, self.now)

    def send(self, name="Ann", visitor="a", wanted=""):
        choice = self.arenas.send(name, visitor, self.now, wanted)
        return choice and (choice.arena.name, choice.waiting)

    def lose(self, visitors: int, arena: str) -> None:
        """So many are sent to that arena, and never seen there."""
        for number in range(visitors):
            assert self.send(f"Lost{number}", f"visitor {number}", arena)[0] == arena


# the choice


def test_a_newcomer_gets_a_free_robot():
    assert Hall(red=seen(waiting=("Bo",)), green=seen(free=1), blue=seen()).send() == ("green", None)


def test_where_somebody_waits_for_another_player_a_battle_begins_soonest():
    hall = Hall(red=seen(free=4), green=seen(free=1, players=("Bo",)), blue=seen(free=3, game=Game.PLAYING))
    assert hall.send() == ("green", None)


def test_an_empty_arena_comes_before_one_in_which_a_battle_runs():
    hall = Hall(red=seen(free=3, players=("Bo", "Cy"), game=Game.PLAYING), green=seen(free=1))
    assert hall.send() == ("green", None)


def test_of_two_equal_ones_the_one_with_more_robots_is_chosen():
    assert Hall(red=seen(free=1), green=seen(free=2)).send() == ("green", None)


def test_two_who_come_together_play_together_and_the_third_goes_where_there_is_a_robot():
    hall = Hall(red=seen(free=2), green=seen(free=2))
    assert [hall.send(name, name)[0] for name in ("Ann", "Bo", "Cy")] == ["red", "red", "green"]


def test_without_a_free_robot_the_queue_with_the_fewest_for_each_robot_is_the_shortest():
    hall = Hall(
        red=seen(players=("A", "B"), waiting=("C", "D")),
        green=seen(players=tuple("EFGH"), waiting=("I", "J", "K")),
    )
    assert hall.send() == ("green", 3)


def test_who_is_on_the_way_to_a_queue_is_counted():
    hall = Hall(red=seen(players=("A",)), green=seen(players=("B",)))
    assert [hall.send(name, name) for name in ("Ann", "Bo", "Cy")] == [("red", 0), ("green", 0), ("red", 1)]


def test_a_tournament_is_for_its_own_players():
    hall = Hall(red=seen(free=5, tournament=True), green=seen(players=("A",), waiting=("B",)))
    assert hall.send() == ("green", 1)


def test_the_arena_that_somebody_wishes_is_chosen_if_it_answers():
    hall = Hall(red=seen(free=5), green=seen(players=("A",)))
    assert hall.send(wanted="green") == ("green", 0)
    assert hall.send(wanted="blue") == ("red", None)
    assert hall.send(wanted="pink") == ("red", None)


def test_without_an_arena_nobody_is_sent_anywhere():
    hall = Hall()
    assert hall.send() is None
    hall.hear(red=seen(free=1))
    hall.now += FRESH
    assert hall.send() is None


def test_whoever_asks_again_does_not_take_two_robots():
    hall = Hall(red=seen(free=1), green=seen(free=1))
    assert [hall.send("Ann")[0], hall.send("Ann")[0], hall.send("Bo")[0]] == ["red", "red", "green"]


# what is believed


def test_who_has_arrived_counts_no_more():
    hall = Hall(red=seen(free=1), green=seen(players=("A",)))
    hall.send()
    hall.hear(red=seen(free=1, players=("Ann",)))
    assert hall.send("Bo") == ("red", None)


def test_a_robot_is_held_for_a_while_only():
    hall = Hall(red=seen(free=1), green=seen(players=("A",)))
    hall.send()
    hall.now += ARRIVES_WITHIN
    hall.hear(red=seen(free=1), green=seen(players=("A",)))
    assert hall.send("Bo") == ("red", None)


def test_an_arena_where_nobody_arrives_comes_last_for_a_while():
    hall = Hall(red=seen(free=128), green=seen(players=("A",)))
    hall.lose(LOST, "red")
    hall.now += ARRIVES_WITHIN
    hall.hear(red=seen(free=128), green=seen(players=("A",)))
    assert hall.send()[0] == "green"
    hall.now += DOUBTED
    hall.hear(red=seen(free=128), green=seen(players=("A",)))
    assert hall.send()[0] == "red"


def test_it_is_believed_again_as_soon_as_somebody_arrives():
    hall = Hall(red=seen(free=128), green=seen(players=("A",)))
    hall.lose(LOST, "red")
    hall.now += ARRIVES_WITHIN
    hall.hear(red=seen(free=128), green=seen(players=("A",)))
    assert hall.send(wanted="red")[0] == "red"
    hall.hear(red=seen(free=127, players=("Ann",)))
    assert hall.send("Bo")[0] == "red"


def test_one_visitor_cannot_bring_an_arena_into_doubt():
    hall = Hall(red=seen(free=128), green=seen(players=("A",)))
    for number in range(3 * LOST):
        hall.send(f"Lost{number}", "always the same", "red")
    hall.now += ARRIVES_WITHIN
    hall.hear(red=seen(free=128), green=seen(players=("A",)))
    assert hall.send()[0] == "red"


# what everybody may know


def test_each_arena_is_told_as_it_is_in_the_order_of_the_list():
    hall = Hall(
        green=seen(free=1, players=("A", "B"), waiting=("C",), game=Game.PLAYING), blue=seen(free=2, tournament=True)
    )
    assert hall.arenas.told(hall.now) == [
        {"name": "red", "address": ":1", "state": "away"},
        {"name": "green", "address": ":2", "state": "playing", "free": 1, "players": 2, "waiting": 1},
        {"name": "blue", "address": ":3", "state": "tournament", "free": 2, "players": 0, "waiting": 0},
    ]


# what an arena says

GOOD = {"game": 2, "available_robots": 3, "users": [{"name": "al"}], "queue": ["bo"], "tournament": 0, "more": [1]}


def test_an_arenas_words_are_read():
    assert read_seen(json.dumps(GOOD).encode()) == seen(3, ("al",), ("bo",), Game.PLAYING)


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"<html>",
        b"[]",
        b"7",
        b"\xff",
        b"[" * 100_000,
        *(json.dumps({**GOOD, field: None}).encode() for field in GOOD if field != "more"),
        *(json.dumps({**GOOD, "available_robots": wrong}).encode() for wrong in (-1, 1.5, True, "3")),
        json.dumps({**GOOD, "users": {}}).encode(),
    ],
    ids=lambda body: body[:30].decode(errors="replace"),
)
def test_what_is_no_state_of_an_arena_is_refused(body):
    with pytest.raises(ValueError, match=r"\w"):
        read_seen(body)


def test_what_is_too_much_is_cut():
    crowd = {
        "available_robots": 10**9,
        "users": [{"name": f"u{n}"} for n in range(500)],
        "queue": ["w"] * 5000,
        "game": 99,
        "tournament": 10**30,
    }
    found = read_seen(json.dumps(GOOD | crowd).encode())
    assert (found.free, found.players, found.waiting, found.game) == (128, 128, 1000, Game.PLAYING)


def test_what_cannot_be_a_name_is_nobody():
    found = read_seen(json.dumps(GOOD | {"queue": [None, 7, "", "x" * 17, {"name": []}, "bo"]}).encode())
    assert found.names == {"al", "bo"}


# the list


def test_the_list_says_where_browsers_go_and_where_the_entrance_asks():
    text = "red=:30510 blue=https://blue.example green=http://g.example:81@10.0.0.7:5000"
    assert read_arenas(text) == (
        ListedArena("red", ":30510", "http://localhost:30510"),
        ListedArena("blue", "https://blue.example", "https://blue.example"),
        ListedArena("green", "http://g.example:81", "http://10.0.0.7:5000"),
    )


@pytest.mark.parametrize(
    "text",
    [
        "red",
        "red=",
        "red=30510",
        "red=:0",
        "red=:70000",
        "red=ftp://x",
        "red=:1@x",
        "red=:1@x:0",
        "r ed=:1",
        "red=https://x/y",
        "red=:1 red=:2",
        " ".join(f"a{n}=:1" for n in range(1001)),
    ],
    ids=lambda text: text[:20],
)
def test_a_wrong_list_is_refused_in_one_line(text):
    with pytest.raises(SettingsError, match="LASERBOT_ARENAS") as refused:
        Settings.from_env({"LASERBOT_ARENAS": text})
    assert "\n" not in str(refused.value)
