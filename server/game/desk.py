"""What operators may decide: pure rules over the state. Each answers with the events that follow, or raises.

`by` is the operator's name. What is true already needs no event; what comes at the wrong moment is refused.
"""

import difflib
import unicodedata
from collections.abc import Mapping, Sequence
from typing import Any

from laser_bot_battle.names import Game
from server.game import events
from server.game.bots import LEVELS, NONE, bot_on, bots
from server.game.events import Event
from server.game.people import BY_OPERATOR
from server.game.presets import of_now
from server.game.rules import DECLARED, Rules, checked
from server.game.state import State
from server.game.users import User, is_same_name, is_valid_name

EARLIER = "an earlier program"  # what was decided in it
MAX_ADDED = 3600  # s at once
MAX_BANNED = 1000  # names
MAX_WORDS = 1000
MAX_WORD = 32  # characters
MAX_MESSAGE = 200  # characters
MAX_PRESETS = 20
MAX_PRESET = 32  # characters of its name


class RefusedError(Exception):
    """Not now; the text says why."""


class UnknownError(RefusedError):
    """There is no such player, robot or name."""


_NO_START = {
    "runs": "a battle is running already",
    "too_few": "a battle takes two players with robots",
    "match": "the match takes both of its players with their robots",
}


def start(state: State, rules: Rules, by: str) -> list[Event]:
    """The battle begins at once: with who is ready in a countdown, else with everybody who has a robot that is here. It
    waits for nothing that is about to restart: the operator knows better."""
    why = why_no_start(state)
    if why:
        raise RefusedError(_NO_START[why])
    if state.game is Game.COUNTDOWN:
        return [state.next_battle(rules, by)]
    ready = [events.ReadyChanged(user.name, True) for user in _fighters(state) if not user.ready]
    released = [events.Released(state.held.what)] if state.held else []
    return [*released, *ready, events.CountdownStarted(0, by)]  # the battle follows as it does every countdown


def why_no_start(state: State) -> str:
    """Why no battle can be started now, one of `_NO_START`; empty if one can."""
    if state.game is Game.PLAYING:
        return "runs"
    if state.game is Game.COUNTDOWN or len(_fighters(state)) >= 2:
        return ""
    return "match" if state.is_match else "too_few"


def _fighters(state: State) -> list[User]:
    """Who can be in the next battle."""
    return [user for user in state.users if user.robot_gone_at is None and state.may_fight(user.name)]


def abort(state: State, _rules: Rules, by: str) -> list[Event]:
    """Countdown or battle end, and nobody has won."""
    _check_runs(state)
    if state.game is Game.COUNTDOWN:
        return [events.CountdownStopped(BY_OPERATOR, by)]
    return [events.BattleEnded(state.battle, BY_OPERATOR, state.ranking(), counts=False, by=by)]


def pause(state: State, _rules: Rules, by: str) -> list[Event]:
    _check_runs(state)
    if state.paused_at is not None:
        raise RefusedError("it is paused already")
    return [events.Paused(by)]


def resume(state: State, _rules: Rules, by: str) -> list[Event]:
    if state.paused_at is None:
        raise RefusedError("nothing is paused")
    return [events.Resumed(by)]


def add_time(state: State, _rules: Rules, by: str, seconds: float) -> list[Event]:
    """ValueError for an impossible number of seconds."""
    if not 1 <= seconds <= MAX_ADDED:
        raise ValueError(f"seconds must be a number from 1 to {MAX_ADDED}")
    _check_runs(state)
    return [events.TimeAdded(seconds, by)]


def change_rules(state: State, _rules: Rules, by: str, changes: Mapping[str, object]) -> list[Event]:
    """New values; None: the environment's again. ValueError if one of them is impossible."""
    unknown = sorted(changes.keys() - DECLARED.keys())
    if unknown:
        nearest = difflib.get_close_matches(unknown[0], DECLARED, 1, 0)[0]
        raise ValueError(f"there is no rule {unknown[0][:40]!r}; the nearest is {nearest}")
    wanted = {rule: None if value is None else checked(rule, value) for rule, value in changes.items()}
    news: dict[str, Any] = {rule: value for rule, value in wanted.items() if value != state.rules.get(rule)}
    return [events.RulesChanged(news, by)] if news else []


def save_preset(state: State, _rules: Rules, by: str, name: str) -> list[Event]:
    """The rules as they are now, under that name. ValueError if it is none."""
    name = name.strip()
    if not 0 < len(name) <= MAX_PRESET or not name.isprintable():
        raise ValueError(f"a preset's name has 1 to {MAX_PRESET} printable characters")
    preset = of_now(name, state.rules)
    if preset in state.presets:
        return []
    if len(state.presets) >= MAX_PRESETS and name not in {one.name for one in state.presets}:
        raise RefusedError(f"{MAX_PRESETS} presets are kept already: remove one first")
    return [events.PresetSaved(preset.name, preset.rules, by)]


def remove_preset(state: State, _rules: Rules, by: str, name: str) -> list[Event]:
    if name not in {preset.name for preset in state.presets}:
        raise UnknownError("there is no such preset of your own")
    return [events.PresetRemoved(name, by)]


def set_service(state: State, _rules: Rules, by: str, robot_id: int, in_service: bool) -> list[Event]:
    """Take a robot out of service, or put it back. Its player is the next to get another one."""
    is_out = robot_id in state.robots.out_of_service
    if state.robots.get_robot(robot_id) is None and not is_out:
        raise UnknownError(f"there is no robot {robot_id}")
    if in_service is not is_out:
        return []
    driver = next((user for user in state.users if user.robot == robot_id), None)
    unseated = [events.Unseated(driver.name, "has a robot that is out of service", first=True)] if driver else []
    return [events.ServiceChanged(robot_id, in_service, by), *unseated]


def give_to_bot(state: State, rules: Rules, by: str, robot_id: int, level: str | None) -> list[Event]:
    """Let a bot of that level drive the robot while nobody else wants it; None: take it back, and the bot is signed out
    at once. ValueError if there is no such level."""
    if level is not None and level not in LEVELS:
        raise ValueError(f"bot must be one of {', '.join(LEVELS)}, or null")
    there = bots(state, rules)
    if state.robots.get_robot(robot_id) is None and robot_id not in there:
        raise UnknownError(f"there is no robot {robot_id}")
    if there.get(robot_id) == level:
        return []
    bot = None if level else bot_on(state, robot_id)
    left = [events.Left(bot.name, "was signed out by the operator", by)] if bot else []
    return [events.BotChosen(robot_id, level or NONE, by), *left]


def sign_out(state: State, _rules: Rules, by: str, name: str) -> list[Event]:
    """Whoever plays or waits under that name."""
    left = _signed_out(state, name, by)
    if not left:
        raise UnknownError("nobody plays or waits under that name")
    return left


def ban(state: State, _rules: Rules, by: str, name: str) -> list[Event]:
    """Nobody may take that name any more; whoever has it is signed out. ValueError if it is no name."""
    name = unicodedata.normalize("NFC", name)
    if not is_valid_name(name):
        raise ValueError("that is no name that a player could have")
    if any(is_same_name(name, banned) for banned in state.banned):
        return []
    if len(state.banned) >= MAX_BANNED:
        raise RefusedError(f"{MAX_BANNED} names are banned already: allow some again")
    return [events.NameBanned(name, by), *_signed_out(state, name, by)]


def unban(state: State, _rules: Rules, by: str, name: str) -> list[Event]:
    if not any(is_same_name(name, banned) for banned in state.banned):
        raise UnknownError("that name is not banned")
    return [events.NameUnbanned(name, by)]


def take_over(state: State, _rules: Rules, saved: Mapping[str, Any]) -> list[Event]:
    """What was decided in an earlier program, whose `saved` state could not be read at the start."""
    undecided = DECLARED.keys() - state.rules.keys()
    rules = {name: value for name, value in saved.get("rules", {}).items() if name in undecided}
    robots = set(saved.get("out_of_service", ())) - state.robots.out_of_service
    names = [name for name in saved.get("banned", ()) if not any(is_same_name(name, one) for one in state.banned)]
    changes: list[Event] = [events.ServiceChanged(robot, False, EARLIER) for robot in sorted(robots)]
    changes += [events.NameBanned(name, EARLIER) for name in names]
    chosen = {int(robot): level for robot, level in saved.get("bots", {}).items()}
    changes += [events.BotChosen(robot, chosen[robot], EARLIER) for robot in sorted(chosen.keys() - state.bots.keys())]
    if rules:
        changes.append(events.RulesChanged(rules, EARLIER))
    presets = {preset.name for preset in state.presets}
    changes += [
        events.PresetSaved(preset["name"], preset["rules"], EARLIER)
        for preset in saved.get("presets", ())
        if preset["name"] not in presets
    ]
    if saved.get("words") and not state.words:
        changes.append(events.WordsChanged(tuple(saved["words"]), EARLIER))
    return changes


def take_drive(_state: State, _rules: Rules, by: str) -> list[Event]:
    return [events.DriveTaken(by)]


def set_words(state: State, _rules: Rules, by: str, words: Sequence[str]) -> list[Event]:
    """The words that no new name may contain. ValueError for impossible ones."""
    if len(words) > MAX_WORDS:
        raise ValueError(f"there may be {MAX_WORDS} words")
    if not all(0 < len(word) <= MAX_WORD and word.isprintable() and not word.isspace() for word in words):
        raise ValueError(f"a word has 1 to {MAX_WORD} printable characters")
    chosen = tuple(dict.fromkeys(words))
    return [events.WordsChanged(chosen, by)] if chosen != state.words else []


def show(state: State, _rules: Rules, by: str, text: str) -> list[Event]:
    """A message to everybody; an empty one takes it back. ValueError if it is too long or not printable."""
    if len(text) > MAX_MESSAGE or not text.isprintable():
        raise ValueError(f"a message has up to {MAX_MESSAGE} printable characters")
    text = text.strip()
    return [events.MessageShown(text, by)] if text != state.message else []


def _check_runs(state: State) -> None:
    if state.game is Game.STOPPED:
        raise RefusedError("neither a countdown nor a battle runs")


def _signed_out(state: State, name: str, by: str) -> list[Event]:
    everybody = [*state.users, *state.queue]
    known = next((one for one in everybody if is_same_name(one.name, name)), None)
    return [events.Left(known.name, "was signed out by the operator", by)] if known else []
