"""The tracker's program in real time: how often and how soon it tells places, and what that costs; how wrong they then
are: test_against_truth.py."""

import statistics

import pytest

from sim.arena.overhead.conditions import Conditions
from tests.bench.bench_overhead import work_of_program


@pytest.mark.slow
def test_places_are_told_often_and_soon_by_less_than_a_core_while_eight_robots_drive_at_full_speed() -> None:
    work = work_of_program(Conditions(), 20)
    assert statistics.quantiles(work.ages, n=100)[94] <= 150
    assert min(work.ages) > 0, "it is measured"
    assert work.rate >= 14.5, "the camera has 15 pictures a second"
    assert work.tracker < 1
