from laser_bot_battle.backoff import Backoff


def test_pauses_are_short_at_first_and_grow_to_the_longest() -> None:
    backoff = Backoff(5)
    assert [backoff.failed() for _ in range(7)] == [0.2, 0.4, 0.8, 1.6, 3.2, 5, 5]


def test_what_has_worked_begins_anew() -> None:
    backoff = Backoff(5)
    for _ in range(4):
        backoff.failed()
    backoff.worked()
    assert [backoff.failed(), backoff.failed()] == [0.2, 0.4]


def test_no_pause_is_longer_than_the_longest() -> None:
    assert Backoff(0.1).failed() == 0.1
