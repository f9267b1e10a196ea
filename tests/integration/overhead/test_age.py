"""How old places are when the tracker tells them, in real time; how wrong they then are: test_against_truth.py."""

import statistics
from contextlib import ExitStack

import pytest

from sim.arena.overhead.conditions import Conditions
from tests.bench.bench_overhead import ages_of_places, started


@pytest.mark.slow
def test_places_are_told_soon_while_eight_robots_drive_at_full_speed() -> None:
    with ExitStack() as stack:
        _, port, _, _ = started(stack, Conditions())
        ages = ages_of_places(port, 20)
    assert statistics.quantiles(ages, n=100)[94] <= 150
    assert min(ages) > 0, "it is measured"
