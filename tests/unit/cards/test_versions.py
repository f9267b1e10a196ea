"""Which version of the game a card runs."""

from dataclasses import replace

import pytest

from cards.versions import REMEMBERED, State, Step, candidates, failed, kept, next_step, proven, taken

OWN = "1"


@pytest.mark.parametrize(
    "state, back, stored, versions",
    [
        (State("1", "1"), False, "", "1"),
        (State("1", "1"), True, "", "1"),
        (State("1", "1", trial="2"), False, "2", "21"),
        (State("3", "2", trial="4"), False, "234", "431"),
        (State("3", "2", trial="4"), True, "234", "21"),
        (State("3", "2"), False, "23", "31"),
        (State("3", "1", trial="1"), False, "3", "13"),
        (State("3", "2"), False, "2", "1"),
        (State("3", "2"), True, "3", "1"),
    ],
)
def test_the_wished_one_comes_first_and_the_cards_own_is_the_last_resort(
    state: State, back: bool, stored: str, versions: str
) -> None:
    assert candidates(state, back, set(stored), OWN) == list(versions)


def test_a_version_that_runs_is_the_newest_and_there_is_one_way_back() -> None:
    state = proven(taken(State("2", "1"), "3", back=False))
    assert state == State("3", "2")
    assert kept(state) - {""} == {"3", "2"}


def test_a_version_that_does_not_run_changes_nothing_but_that_it_is_known() -> None:
    state = failed(taken(State("2", "1"), "3", back=False))
    assert state == State("2", "1", refused=("3",))
    for number in range(REMEMBERED + 3):
        state = failed(replace(state, trial=f"x{number}"))
    assert len(state.refused) == REMEMBERED
    assert state.refused[-1] == f"x{REMEMBERED + 2}"


@pytest.mark.parametrize(
    "state, version, back, expected",
    [
        (State("2", "1", refused=("3", "4")), "3", False, State("2", "1", "3", ("4",))),
        (State("2", "1", trial="3"), "4", False, State("2", "1", "4")),
        (State("2", "1", trial="3"), "2", False, State("2", "1")),
        (State("2", "1"), "1", False, State("2", "1", "1")),
        # what a person has gone back to is what there is a way back to from then on
        (State("3", "2"), "4", True, State("2", "2", "4")),
        (State("3", "2"), "3", True, State("2", "2", "3")),
    ],
)
def test_what_a_person_gives_is_tried_whatever_became_of_it_before(
    state: State, version: str, back: bool, expected: State
) -> None:
    assert taken(state, version, back) == expected


def test_going_forth_and_back_between_two_keeps_both() -> None:
    state = State("2", "1")
    for there, back in (("1", "2"), ("2", "1")):
        state = proven(replace(state, trial=there))
        assert state == State(there, back)


@pytest.mark.parametrize(
    "state, served, has_files, stored, step",
    [
        (State("1", "1"), "1", False, "", Step.STAY),
        (State("1", "1"), "2", True, "", Step.FETCH),
        (State("1", "1"), "2", False, "", Step.STAY),  # the master's own, of which there is nothing to get
        (State("1", "1"), "2", True, "2", Step.SWITCH),  # it came during a battle
        (State("2", "1"), "1", False, "2", Step.SWITCH),
        (State("3", "2"), "2", True, "23", Step.SWITCH),
        (State("1", "1", refused=("2",)), "2", True, "", Step.STAY),
        (State("1", "1", trial="2"), "3", True, "2", Step.STAY),
    ],
)
def test_a_robot_follows_its_master(state: State, served: str, has_files: bool, stored: str, step: Step) -> None:
    assert next_step(state, served, has_files, set(stored), OWN) is step
