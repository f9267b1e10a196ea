"""Budgets: so many at once, then one in a while, for each key."""

import pytest

from laser_bot_battle.token_bucket import TokenBuckets


def test_a_few_at_once_and_then_one_per_period() -> None:
    buckets = TokenBuckets(burst=4, period=3.0)
    assert [buckets.take("a", 1000.1) for _ in range(4)] == [0.0] * 4
    assert buckets.take("a", 1000.1) == pytest.approx(3.0)
    assert buckets.take("a", 1002.1) == pytest.approx(1.0), "asking costs nothing"
    assert buckets.take("a", 1003.1) == 0.0
    assert buckets.take("a", 1003.2) > 0.0


def test_what_is_charged_has_to_come_back() -> None:
    buckets = TokenBuckets(burst=4, period=3.0)
    buckets.charge("a", 5, 1000.0)
    assert buckets.take("a", 1000.0) == pytest.approx(6.0)
    assert buckets.take("b", 1000.0) == 0.0
    assert buckets.take("a", 1006.0) == 0.0


def test_nobody_pays_for_another_and_time_heals() -> None:
    buckets = TokenBuckets(burst=2, period=1.0)
    for _ in range(5):
        buckets.take("a", 10.0)
    assert buckets.take("b", 10.0) == 0.0
    assert [buckets.take("a", 100.0) > 0 for _ in range(3)] == [False, False, True]


def test_no_more_keys_are_remembered_than_there_is_room_for() -> None:
    buckets = TokenBuckets(burst=1, period=1.0, keys=2)
    for key in "abc":
        buckets.take(key, 0.0)
    assert (buckets.take("b", 0.0) > 0, buckets.take("c", 0.0) > 0, buckets.take("a", 0.0) > 0) == (True, True, False)
