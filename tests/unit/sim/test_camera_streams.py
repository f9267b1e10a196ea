"""An eye is painted as often as the one wants who wants most."""

import pytest

from sim.arena.cameras.streams import Eye, Picture

FULL = 20


def painted(eye: Eye, turns: int) -> list[int]:
    """The turns of the painter, from 0 on, in which there is a picture."""
    due = []
    for turn in range(turns):
        if eye.is_due(FULL):
            due.append(turn)
            eye.show(Picture(float(turn), b"jpeg"))
    return due


@pytest.mark.parametrize(
    ("rates", "turns"),
    [
        ([20], [0, 1, 2, 3, 4, 5, 6, 7, 8]),
        ([10], [0, 2, 4, 6, 8]),
        ([5], [0, 4, 8]),
        ([5, 10, 5], [0, 2, 4, 6, 8]),
        ([7], [0, 3, 6]),
    ],
)
def test_the_highest_rate_counts(rates: list[int], turns: list[int]) -> None:
    assert painted(Eye(rates), 9) == turns


def test_so_many_are_painted_in_a_minute() -> None:
    for rate in range(1, FULL + 1):
        assert len(painted(Eye([rate]), 60 * FULL)) == pytest.approx(60 * rate, abs=1)


def test_who_wants_more_gets_it_at_once_and_leaves_the_others_with_less() -> None:
    eye = Eye([5])
    assert painted(eye, 4) == [0]
    eye.rates.append(FULL)
    assert painted(eye, 4) == [0, 1, 2, 3]
    eye.rates.remove(FULL)
    assert len(painted(eye, 8)) == 2
