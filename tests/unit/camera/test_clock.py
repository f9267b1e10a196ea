"""How far a robot's clock is from the master's."""

from server.camera.clock import JUMP, WINDOW, ClockOffset

AHEAD = 500.0  # s that the robot's clock is


def offsets(*ways: float, began: float = 0.0, ahead: float = AHEAD, clock: ClockOffset | None = None) -> list[float]:
    """What is known after each picture, one a second, which has been on its way for so many s."""
    clock = clock or ClockOffset()
    times = [began + second for second in range(len(ways))]
    return [clock.sample(now - way + ahead, now) for now, way in zip(times, ways, strict=True)]


def test_the_shortest_way_tells() -> None:
    assert offsets(0.5, 0.25, 1.0, 0.5) == [-499.5, -499.75, -499.75, -499.75]


def test_what_is_old_no_longer_counts() -> None:
    """The robot has gone where the way is longer; or its clock is slow."""
    clock = ClockOffset()
    offsets(0.25, clock=clock)
    known = offsets(*[0.5] * 70, began=1, clock=clock)
    assert known[0] == -499.75
    assert known[-1] == -499.5
    assert known.index(-499.5) <= 2 * WINDOW


def test_a_clock_that_is_set_is_known_at_once() -> None:
    clock = ClockOffset()
    offsets(0.25, 0.25, clock=clock)
    assert offsets(0.25, began=2, ahead=AHEAD + 3600, clock=clock) == [-4099.75]
    assert offsets(0.25, began=3, ahead=AHEAD - 3600, clock=clock) == [3100.25]


def test_a_late_picture_is_old_and_not_a_clock_that_was_set() -> None:
    assert offsets(0.25, 0.25 + JUMP)[-1] == -499.75


def test_no_picture_is_ever_from_the_future() -> None:
    clock = ClockOffset()
    for sent, received in [(5.0, 9.0), (6.0, 9.0), (7.0, 8.0), (30.0, 8.5), (1.0, 100.0), (99.0, 20.0)]:
        assert sent + clock.sample(sent, received) <= received
