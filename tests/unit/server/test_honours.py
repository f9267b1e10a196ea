"""Who did best on a day, and in what."""

from server.store.honours import AIMED, honours
from server.store.results import Standing


def standing(name: str, *, kills: int | None = 0, shots: int | None = 0, accuracy: float | None = None) -> Standing:
    return Standing(1, name, 1, 0, 0, 0.0, shots, 0, kills, accuracy)


def told(*arguments) -> dict[str, tuple[str, float]]:
    return {one.kind: (one.name, one.value) for one in honours(*arguments)}


def test_without_battles_there_is_nobody_to_name():
    assert told([], []) == {}
    assert told([standing("ada", kills=None, shots=None)], [[("ada", True)]]) == {}, "plain light tells nothing"


def test_the_most_taken_out_are_named():
    assert told([standing("ada", kills=2), standing("bob", kills=5)], []) == {"kills": ("bob", 5)}


def test_of_equals_the_one_that_is_ahead_is_named():
    assert told([standing("ada", kills=5), standing("bob", kills=5)], [])["kills"] == ("ada", 5)


def test_the_best_aim_takes_some_shots():
    lucky = standing("ada", shots=AIMED - 1, accuracy=1.0)
    good = standing("bob", shots=AIMED, accuracy=0.4)
    better = standing("cy", shots=90, accuracy=0.5)
    assert told([lucky, good, better], []) == {"accuracy": ("cy", 0.5)}


def test_the_longest_streak_is_of_battles_that_somebody_was_in():
    battles = [
        [("ada", True), ("bob", False)],
        [("cy", True), ("bob", False)],
        [("ada", True), ("cy", False)],
        [("ada", True), ("cy", True)],
        [("ada", False), ("cy", True)],
    ]
    assert told([standing("cy"), standing("ada"), standing("bob")], battles) == {"streak": ("ada", 3)}


def test_one_win_is_no_streak():
    assert told([standing("ada")], [[("ada", True)]]) == {}
