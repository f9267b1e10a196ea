"""What the status LED shows. Times are those of the patterns; nobody waits for them."""

import pytest
from gpiod.line import Value

from robot.gpio_line import GpioLine
from robot.status_led import Indication, LedThread, State, lit
from tests.support.gpio import RecordedRequest
from tests.support.polling import until


def test_from_the_start_it_is_lit() -> None:
    assert all(lit(State.STARTING, seconds / 7) for seconds in range(1000))


@pytest.mark.parametrize(
    ("state", "half"), [pytest.param(State.WORKING, 0.5, id="working"), pytest.param(State.FAILING, 0.1, id="failing")]
)
def test_it_blinks_beginning_dark(state: State, half: float) -> None:
    for number in range(1000):
        assert lit(state, (number + 0.01) * half) == (number % 2 == 1)
        assert lit(state, (number + 0.99) * half) == (number % 2 == 1)


class Led:
    """An LED whose time is told by the test."""

    def __init__(self) -> None:
        self.indication = Indication()
        self.request = RecordedRequest()
        self.thread = LedThread(self.indication, GpioLine(self.request, 18))

    def changes(self, begin: float, end: float) -> list[bool]:
        """What is written between two times, if the thread looks every 20 ms."""
        self.request.values.clear()
        for tick in range(round((end - begin) * 50)):
            self.thread.update(begin + tick / 50)
        return [value == Value.ACTIVE for _, value in self.request.values]


@pytest.fixture
def led() -> Led:
    return Led()


def test_only_changes_are_written(led: Led) -> None:
    assert led.changes(50.0, 60.0) == []  # lit from the beginning
    led.indication.state = State.WORKING
    assert led.changes(60.0, 64.0) == [False, True] * 4


def test_each_state_begins_with_its_own_first_phase(led: Led) -> None:
    led.indication.state = State.WORKING
    assert led.changes(10.0, 10.7) == [False, True]
    led.indication.state = State.FAILING
    assert led.changes(10.7, 11.1) == [False, True] * 2
    led.indication.state = State.WORKING
    assert led.changes(11.1, 11.55) == [False]


def test_a_state_that_is_said_again_goes_on(led: Led) -> None:
    led.indication.state = State.WORKING
    assert led.changes(0.0, 0.4) == [False]
    led.indication.state = State.WORKING
    assert led.changes(0.4, 0.8) == [True]


def test_in_the_end_it_is_dark_and_the_line_is_free(led: Led) -> None:
    with led.thread:
        assert not led.request.released
    assert led.request.values == [(18, Value.INACTIVE)]
    assert led.request.released


def test_a_line_that_is_lost_ends_the_thread_with_a_warning(led: Led, caplog: pytest.LogCaptureFixture) -> None:
    led.request.gone = True
    led.indication.state = State.FAILING
    with led.thread:
        until(lambda: not led.thread.is_alive())
    assert [record.getMessage() for record in caplog.records] == [
        "the status LED can no longer be set: [Errno 19] No such device"
    ]
    assert led.request.released
