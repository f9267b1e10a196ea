"""What all pictures together may cost."""

import pytest

from server.camera.budget import BURST, DEBT, Budget, Meter

RATE = 1000.0  # bytes/s


def spectators_bytes(seconds: float, own: float) -> float:
    """Bytes/s that spectators who want all get in 10-byte pictures, while players take `own` bytes/s."""
    budget, now, sent = Budget(RATE), 0.0, 0
    for _ in range(round(seconds * 100)):
        budget.spend(round(own / 100), now)
        while not budget.wait(now):
            budget.spend(10, now)
            sent += 10
        now += 0.01
    return sent / seconds


def test_spectators_get_what_players_leave() -> None:
    assert spectators_bytes(20, 0) == pytest.approx(RATE, rel=0.05)
    assert spectators_bytes(20, 600) == pytest.approx(RATE - 600, rel=0.05)
    assert spectators_bytes(20, 5000) == pytest.approx(0, abs=RATE * BURST)


def test_it_tells_when_the_next_may_go() -> None:
    budget = Budget(RATE)
    budget.spend(400, 0)
    wait = budget.wait(0)
    assert wait == pytest.approx(0.2, abs=0.01)
    assert budget.wait(wait) == 0


def test_what_was_not_used_is_not_saved_for_long() -> None:
    budget = Budget(RATE)
    budget.spend(1, 1000)
    budget.spend(round(RATE * BURST), 1000)
    assert budget.wait(1000) > 0


def test_players_who_take_more_than_all_do_not_shut_spectators_out_for_long_afterwards() -> None:
    budget = Budget(RATE)
    budget.spend(10**9, 0)
    assert budget.wait(0) <= DEBT + 0.01


def test_a_meter_tells_the_rate_of_the_last_seconds() -> None:
    meter = Meter(0.0)
    assert meter.rate(0.0) == 0
    for tenth in range(100):
        meter.add(5 if tenth < 50 else 1)
        meter.mark((tenth + 1) / 10)
        if tenth == 9:
            assert meter.rate(1.0) == pytest.approx(50)
    assert meter.rate(10.0) == pytest.approx(10)
