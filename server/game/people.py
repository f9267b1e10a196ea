"""Where names of people stand in what is kept: the types of the fields tell it, of the events' and of the state's.

By its value alone, a rule, a word of the operators' list or a part of a sentence may be taken for a name.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import is_dataclass
from functools import partial
from itertools import groupby
from types import UnionType
from typing import Annotated, Any, get_args, get_origin, get_type_hints
from unicodedata import category

MAX_NAME = 16  # characters

Rename = Callable[[str], str]  # what is to stand in the place of a name
Renamer = Callable[[Any, Rename], Any]  # of a value of JSON's types; what is of an unexpected type stays as it is

# causes of an end that name nobody: every other one begins with a name
TIME_LIMIT = "the time limit is reached"
BY_OPERATOR = "the operator has ended it"
NAMELESS = frozenset({TIME_LIMIT, BY_OPERATOR})

AGAIN = "signed up again as "  # how somebody leaves; the one such text in which a name follows
# what else follows a name: since names have spaces, they end where one of these begins
_HOW = re.compile(
    "|".join(
        (
            "was shot down|is no longer ready|lost the robot|signed out|left the page|makes room for a person",
            "makes room for a match of the tournament|has a robot that is out of service",
            "was signed out by the operator|did not take the robot in time",
            r"was not ready for \S+ s while others waited|has played \d+ in a row, and others wait",
            r"has one of several robots at one address, and others wait|has had the robot for \S+ min, and others wait",
        )
    )
)

NEUTRAL = re.compile(r"player \d+")  # of somebody who was forgotten: no player can choose it
_AGAIN = re.compile(rf"(.+?) ({AGAIN}.+)")  # no name is so long that these words could be in it
_CAUSE = re.compile(rf"(.+) ({_HOW.pattern})")
_OTHER = re.compile(rf"({NEUTRAL.pattern}|\S+) (.+)")  # another version's, from when no name had a space
_NOTICE = re.compile(r"(Battle over|Countdown stopped): (.+?)(, fewer than two players are ready)?\.")


def _in_name(text: str, rename: Rename) -> str:
    return rename(text) if text else text


def _in_how(text: str, rename: Rename) -> str:
    return AGAIN + rename(text.removeprefix(AGAIN)) if text.startswith(AGAIN) else text


def _in_cause(text: str, rename: Rename) -> str:
    if text in NAMELESS:
        return text
    found = _AGAIN.fullmatch(text) or _CAUSE.fullmatch(text) or _OTHER.fullmatch(text)
    return f"{rename(found[1])} {_in_how(found[2], rename)}" if found else text


def _in_notice(text: str, rename: Rename) -> str:
    found = _NOTICE.fullmatch(text)
    return f"{found[1]}: {_in_cause(found[2], rename)}{found[3] or ''}." if found else text


def _in_words(text: str, rename: Rename) -> str:
    """Nobody but its writer knows which of the words are names, so each may be, and several together."""
    parts = [(is_word, "".join(chars)) for is_word, chars in groupby(text, _belongs_to_name)]
    renamed, place = "", 0
    while place < len(parts):
        name, length = _name_in(parts[place:], rename)
        renamed += name
        place += length
    return renamed


def _name_in(parts: list[tuple[bool, str]], rename: Rename) -> tuple[str, int]:
    """What stands for the first of the parts, or for the most that are a name together; and how many they are."""
    end = 1 if parts[0][0] else 0
    while 0 < end < len(parts) - 1 and parts[end] == (False, " "):
        end += 2
    for length in range(end, 0, -2):
        name = "".join(part for _, part in parts[:length])
        if len(name) <= MAX_NAME and (renamed := rename(name)) != name:
            return renamed, length
    return parts[0][1], 1


def _belongs_to_name(char: str) -> bool:
    return char == "_" or category(char)[0] in "LMN"


Name = Annotated[str, _in_name]  # of a player or an operator, or ""
How = Annotated[str, _in_how]  # after a name: "signed out"
Cause = Annotated[str, _in_cause]  # "ada signed out"
Notice = Annotated[str, _in_notice]  # "Battle over: ada signed out."
Words = Annotated[str, _in_words]  # an operator's own


def renamers(kind: Any) -> dict[str, Renamer]:
    """How the names are replaced in each field of a dataclass that may have some."""
    hints = get_type_hints(kind, include_extras=True)
    return {field: renamer for field, hint in hints.items() if (renamer := _renamer(hint))}


def rename_fields(fields: Mapping[str, Any], rename: Rename, by_field: Mapping[str, Renamer]) -> dict[str, Any]:
    """`fields` with the names replaced in those that `by_field` has."""
    return {name: by_field[name](value, rename) if name in by_field else value for name, value in fields.items()}


def rename_each(values: Any, rename: Rename, by_field: Mapping[str, Renamer]) -> Any:
    """The same in each of a list."""
    if not isinstance(values, list | tuple):
        return values
    return [rename_fields(one, rename, by_field) if isinstance(one, Mapping) else one for one in values]


def _renamer(hint: Any) -> Renamer | None:
    """Of a field of that type; None if there is no name in it."""
    if get_origin(hint) is Annotated:
        return partial(_in_text, hint.__metadata__[0])
    if get_origin(hint) in (list, tuple):
        inner = _renamer(get_args(hint)[0])
        return partial(_in_each, inner) if inner else None
    if get_origin(hint) is UnionType:  # with None
        return _renamer(get_args(hint)[0])
    by_field = renamers(hint) if is_dataclass(hint) else {}
    return partial(_in_fields, by_field) if by_field else None


def _in_each(inner: Renamer, values: Any, rename: Rename) -> Any:
    return [inner(value, rename) for value in values] if isinstance(values, list | tuple) else values


def _in_fields(by_field: Mapping[str, Renamer], value: Any, rename: Rename) -> Any:
    return rename_fields(value, rename, by_field) if isinstance(value, Mapping) else value


def _in_text(rename_in: Callable[[str, Rename], str], text: Any, rename: Rename) -> Any:
    return rename_in(text, rename) if isinstance(text, str) else text


def signature(by: str) -> str:
    """After what an operator has decided; empty: the rules did."""
    return f" (by {by})" if by else ""
