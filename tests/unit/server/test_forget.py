"""Who is forgotten is renamed where a person is named, and nowhere else, whatever the name."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy import Connection, create_engine, insert, select

from laser_bot_battle.names import Game
from server.game import changes, events, place_events, tournament_events
from server.game.draw import Kind
from server.game.events import Event, Fighter, kind_of, to_json
from server.game.handicap import Losing
from server.game.people import AGAIN, BY_OPERATOR, TIME_LIMIT
from server.game.persistence import save
from server.game.presets import Preset
from server.game.robot import Robots
from server.game.snapshot import Happening, Placing
from server.game.state import State
from server.game.tournament import Tournament
from server.game.users import User, Users, Waiting
from server.store import schema, versions
from server.store.forget import ForgetError, find_forgotten, forget, rename_in_event, rename_in_state

# names that a player can have, and that stand elsewhere, too: values, keys, kinds, parts of sentences
WORDS = (
    *("coded", "plain", "light", "idiot", "name", "by", "cause", "how", "rules", "words", "banned", "robot", "Hit"),
    *("BattleEnded", "the", "time", "limit", "is", "reached", "operator", "has", "ended", "it", "was", "shot", "down"),
    *("signed", "out", "up", "again", "as", "Battle", "over", "Countdown", "stopped", "fewer", "two", "players", "are"),
    *("ready", "player", "1", "2", "None", "true", "0", "caller", "red", "Ann", "anybody"),
    *("Ann Lee", "signed out", "was shot down", "lost the robot", "out again"),
)
# a name, and what stands elsewhere: often the same
PAIRS = st.sampled_from(WORDS).flatmap(lambda name: st.tuples(st.just(name), st.just(name) | st.sampled_from(WORDS)))


def happened(who: str, word: str) -> list[Event]:
    """Every event: `who` is a person, `word` stands wherever none is named."""
    placings = (
        Placing(name=who, robot=1, life=20, avatar=2, place=1, left=False),
        Placing(name="Zoë", robot=2, life=0, avatar=3, place=2, left=True),
    )
    return [
        events.RobotCame(1, f"/{word}", word, word),
        events.RobotRefused(word),
        events.RobotLinked(1, True, word),
        events.RobotGone(1),
        events.SignedUp(who, 1, word, 2, word),
        events.Queued(who, word, 2, word),
        events.Offered(who, 1, 20.0),
        events.OfferMissed(who),
        events.Seated(who),
        events.Unseated(who, "has played 3 in a row, and others wait"),
        events.Left(who, "was signed out by the operator", who),
        events.Left("Zoë", f"{AGAIN}{who}"),
        events.Left("Zoë", f"{AGAIN}player 7"),
        events.ReadyChanged(who, True),
        events.TeamChosen(who, 2),
        events.CountdownStarted(15.0),
        events.CountdownStopped(f"{who} is no longer ready"),
        events.CountdownStopped(BY_OPERATOR, who),
        events.BattleStarted(3, 300.0, (Fighter(who, 1, 2), Fighter("Zoë", 2, 3)), who),
        events.Joined(who, 1, 2, 90),
        events.Hit(who, 1, 90, "Zoë"),
        events.Hit("Zoë", 2, 0, who),
        place_events.Fenced(who, 1, True, False),
        place_events.HillHeld(who, 1, 12, 0.8, 0.6, 0.2),
        place_events.HillOpened(word, 0.8, 0.6, 0.2),
        place_events.HitRefused(who, 1, 20, who),
        place_events.PickUpLaid(word, "repair", 0.8, 0.6, 0.2),
        place_events.PickedUp(who, 1, word, "shield", 40, 8.0),
        place_events.EffectEnded(who, 1, "shield"),
        events.BattleEnded(3, TIME_LIMIT, placings),
        events.BattleEnded(3, f"{who} was shot down", placings),
        events.BattleEnded(3, f"Zoë {AGAIN}{who}", placings),
        events.BattleEnded(3, "player 7 was shot down", placings),
        events.BattleEnded(3, BY_OPERATOR, placings, False, who),
        events.Held("robot 1"),
        events.Released("robot 1"),
        events.StoodStill(2.0),
        events.Paused(who),
        events.Resumed(who),
        events.TimeAdded(5.0, who),
        events.RulesChanged({"light": word, word: None}, who),
        events.PresetSaved(f"of {who}", {"light": word}, who),
        events.PresetRemoved(f"of {who}", who),
        events.ServiceChanged(1, False, who),
        events.BotChosen(1, "easy", who),
        events.FloorChanged(who),
        events.NameBanned(who, who),
        events.NameUnbanned(who, who),
        events.WordsChanged((word, "Zoë"), who),
        events.MessageShown(f"{who}!", who),
        events.DriveTaken(who),
        tournament_events.TournamentOpened(f"Cup of {who}", "knock-out", (who, "Zoë"), 1, False, 0, 60.0, who),
        tournament_events.MatchCalled(1, (who, "Zoë"), (1, 2), who),
        tournament_events.GameWon(1, who, 3),
        tournament_events.NoShow(1, who, "Zoë", who),
        tournament_events.NoShow(1, "Zoë", who),
        tournament_events.MatchCorrected(1, who, f"{who}!", who),
        tournament_events.TournamentClosed(who),
    ]


def saved(who: str, word: str, ended: Event) -> dict[str, Any]:
    """The state in which nobody called `who` is any more, though the game remembers one; after `ended`."""
    users = Users()
    users.add_user(User("Zoë", 2, word, 3, seen=0.0, address=word))
    robots = Robots()
    robots.put(2, word, 0.0, word, word)
    state = State(robots, users, Game.PLAYING, battle=3, queue=[Waiting("Ada", word, 1, 0.0, 0.0, address=word)])
    changes.apply(state, ended, 10.0)
    state.leavers = [User(who, 1, word, 2, seen=0.0, left_at=5.0)]
    state.losing = (Losing(who, 2), Losing("Zoë", 1))
    state.result = (Placing(name=who, robot=1, life=20, avatar=2, place=1, left=True),)
    state.happened = (Happening(1, "Zoë", who, 90), Happening(2, who, "", 90))
    state.rules, state.words, state.message = {"light": word}, (word, "Zoë"), f"({who})"
    state.presets = (Preset(f"of {who}", {"light": word}),)
    state.banned = [f"{word}x"]
    state.tournament = Tournament(f"Cup of {who}", Kind.KNOCK_OUT, (who, "Zoë", "Ada", "Bo"))
    return through_json(save(state, 20.0))


def ends(who: str) -> list[Event]:
    """After which a notice tells why."""
    return [
        events.CountdownStopped(f"{who} {AGAIN}{who}"),
        events.CountdownStopped(BY_OPERATOR, "Ann"),
        events.BattleEnded(3, f"{who} lost the robot", ()),
        events.BattleEnded(3, TIME_LIMIT, ()),
    ]


def through_json(data: Any) -> Any:
    return json.loads(json.dumps(data))


@contextmanager
def kept(who: str, word: str) -> Iterator[Connection]:
    """A database with all that may be in one."""
    engine = create_engine("sqlite://")
    with engine.begin() as connection:
        versions.prepare(connection)
        connection.execute(insert(schema.robots).values(caller=f"/{word}", robot=1))
        connection.execute(insert(schema.tracks).values(battle=1, data={"floor": word}))
        for event in happened(who, word):
            row = {"at": 1.0, "kind": kind_of(event), "data": to_json(event), "arena": word}
            connection.execute(insert(schema.events).values(row))
            if isinstance(event, events.BattleEnded):
                fields = to_json(event)
                battle = {"number": 3, "began": 0.0, "ended": 1.0, "cause": event.cause, "result": fields["result"]}
                connection.execute(insert(schema.battles).values(arena=word, **battle))
        for name in (who, "Zoë"):
            fighter = {"battle": 1, "robot": 1, "avatar": 2, "life": 20, "hits": 8, "seconds": 9.0}
            connection.execute(insert(schema.fighters).values(name=name, **fighter))
        for number, ended in enumerate(ends(who)):
            data = saved(who, word, ended)
            connection.execute(insert(schema.state).values(arena=f"{word} {number}", at=1.0, data=data))
        yield connection
    engine.dispose()


def content(connection: Connection) -> dict[str, list[Any]]:
    """All but what is known of the forgotten."""
    tables = (table for table in schema.metadata.sorted_tables if table is not schema.forgotten)
    return {table.name: [tuple(row) for row in connection.execute(select(table))] for table in tables}


def test_every_kind_of_event_is_among_those_that_are_tried():
    assert {kind_of(event) for event in happened("ada", "x")} == events.KINDS.keys()


@given(pair=PAIRS)
@settings(max_examples=60)
def test_a_forgotten_player_has_another_name_and_nothing_else_has_changed(pair: tuple[str, str]):
    name, word = pair
    with kept(name, word) as connection, kept("player 1", word) as expected:
        assert forget(connection, name) == "player 1"
        assert content(connection) == content(expected)


@given(pair=PAIRS)
def test_what_a_running_server_writes_afterwards_is_renamed_likewise(pair: tuple[str, str]):
    name, word = pair
    names = {name: "player 1"}
    for event, expected in zip(happened(name, word), happened("player 1", word), strict=True):
        renamed = rename_in_event(kind_of(event), to_json(event), names)
        assert through_json(renamed) == through_json(to_json(expected))
    for event, expected in zip(ends(name), ends("player 1"), strict=True):
        assert rename_in_state(saved(name, word, event), names) == saved("player 1", word, expected)


@pytest.mark.parametrize("word", ["coded", "idiot", "Hit", "the", "Battle"])
def test_a_word_that_is_nobodys_name_is_not_forgotten(word: str):
    with kept("ada", word) as connection:
        before = content(connection)
        with connection.begin_nested() as attempt:
            with pytest.raises(ForgetError, match="nobody called"):
                forget(connection, word)
            attempt.rollback()
        assert content(connection) == before


@pytest.mark.parametrize(
    "forgetful",
    [
        lambda state: state | {"leavers": [], "happened": [], "message": ""},
        lambda state: state | {"leavers": [], "result": [], "happened": [], "message": ""},
        lambda state: state | {"leavers": [], "result": [], "message": "", "notice": ""},
    ],
    ids=["result", "notice", "happened"],
)
def test_a_server_is_told_as_long_as_it_names_the_player_anywhere(forgetful: Callable[[Any], dict[str, Any]]):
    with kept("ada", "x") as connection:
        state = forgetful(saved("ada", "x", ends("ada")[0]))
        forget(connection, "ada")
        assert find_forgotten(connection, state, "x 0") == {"ada": "player 1"}
        assert find_forgotten(connection, saved("bob", "x", ends("bob")[0]), "x 0") == {}
        assert find_forgotten(connection, state, "x 0") == {}, "whoever comes now is somebody new"


def test_an_event_of_another_version_has_names_where_others_have_them():
    fields = {"name": "ada", "light": "ada", "result": [{"name": "ada"}, 3], "cause": 4, "fighters": None}
    renamed = {"name": "player 1", "light": "ada", "result": [{"name": "player 1"}, 3], "cause": 4, "fighters": None}
    assert rename_in_event("Danced", fields, {"ada": "player 1"}) == renamed


def test_in_an_operators_own_words_any_whole_word_may_be_the_name():
    fields = {"text": "the other_the théo Thea the, the", "by": "the"}
    renamed = rename_in_event("MessageShown", fields, {"the": "player 1"})
    assert renamed == {"text": "player 1 other_the théo Thea player 1, player 1", "by": "player 1"}


def test_names_of_several_words_are_told_from_those_of_fewer():
    def renamed(cause: str, name: str) -> str:
        return str(rename_in_event("CountdownStopped", {"cause": cause}, {name: "player 1"})["cause"])

    for how in (
        "did not take the robot in time",
        "was not ready for 60 s while others waited",
        "has played 3 in a row, and others wait",
        "has one of several robots at one address, and others wait",
        "has had the robot for 2.5 min, and others wait",
        "makes room for a person",
        "is no longer ready",
        "left the page",
        f"{AGAIN}Bo Lee",
    ):
        assert renamed(f"Ann Lee {how}", "Ann Lee") == f"player 1 {how}"
        assert renamed(f"Ann Lee {how}", "Ann") == f"Ann Lee {how}"
    assert renamed(f"Al {AGAIN}A was shot down", "Al") == f"player 1 {AGAIN}A was shot down"

    def message(text: str, name: str) -> str:
        return str(rename_in_event("MessageShown", {"text": text}, {name: "player 1"})["text"])

    assert message("Well done, Ann Lee and Ann Leeson!", "Ann Lee") == "Well done, player 1 and Ann Leeson!"
    assert message("Well done, Ann and Ann Leeson!", "Ann") == "Well done, player 1 and player 1 Leeson!"
