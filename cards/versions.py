"""Which version of the game a card runs: from what it remembers, what it has stored, and what its master serves."""

from collections.abc import Collection
from dataclasses import dataclass, replace
from enum import Enum, auto

REMEMBERED = 16  # of the versions that did not run


@dataclass(frozen=True)
class State:
    """What a card remembers. The version that the card itself was made with is its own; it needs not be stored."""

    current: str  # the newest that has run
    previous: str  # the one before, to which there is a way back
    trial: str = ""  # has yet to show that it runs here
    refused: tuple[str, ...] = ()  # did not run here: not taken from a master again


class Step(Enum):
    """What a robot does about the version that its master serves."""

    STAY = auto()
    FETCH = auto()
    SWITCH = auto()


def candidates(state: State, back: bool, stored: Collection[str], own: str) -> list[str]:
    """The versions that the card may run, the wished one first; its own is the last resort.

    `back`: laserbot.txt says `version = previous`.
    """
    wished = (state.previous,) if back else (state.trial, state.current)
    return list(dict.fromkeys([*(version for version in wished if version in {*stored, own}), own]))


def taken(state: State, version: str, back: bool) -> State:
    """A person has given that version to the card: it is tried whatever became of it before."""
    if back:  # what runs now is what one goes back to from then on
        state = replace(state, current=state.previous)
    refused = tuple(other for other in state.refused if other != version)
    return replace(state, trial="" if version == state.current else version, refused=refused)


def tried(state: State, version: str) -> State:
    """The robot's master runs that version."""
    return replace(state, trial=version)


def proven(state: State) -> State:
    """The version on trial runs."""
    previous = state.previous if state.trial == state.current else state.current
    return replace(state, current=state.trial, previous=previous, trial="")


def failed(state: State) -> State:
    """The version on trial does not run here."""
    return replace(state, trial="", refused=(*state.refused, state.trial)[-REMEMBERED:])


def kept(state: State) -> set[str]:
    """The versions that are not removed."""
    return {state.current, state.previous, state.trial}


def next_step(state: State, served: str, has_files: bool, stored: Collection[str], own: str) -> Step:
    """`served` is the version that the master runs. Without files, its own card was made with it."""
    if state.trial or served == state.current or served in state.refused:
        return Step.STAY
    if served in stored or served == own:
        return Step.SWITCH
    return Step.FETCH if has_files else Step.STAY
