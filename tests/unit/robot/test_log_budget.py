"""How many log lines of a sketch are passed on."""

from robot.rosserial.events import DeviceLog, Event, Message
from robot.rosserial.log_budget import BURST, LogBudget

LINE = DeviceLog(1, "still here")


def left_out(count: str) -> DeviceLog:
    return DeviceLog(2, f"{count} further log lines of the sketch were left out")


def test_a_sketch_that_says_little_is_passed_on_at_once() -> None:
    budget = LogBudget()
    assert budget.within([LINE] * BURST, 0.0) == [LINE] * BURST
    for second in range(1, 60):
        assert budget.within([LINE] * 5, float(second)) == [LINE] * 5


def test_of_a_flood_some_lines_and_its_size_are_told() -> None:
    budget = LogBudget()
    assert budget.within([LINE] * 20_005, 0.0) == [LINE] * 20
    assert budget.within([], 0.9) == []
    assert budget.within([], 1.0) == [left_out("19,985")]
    assert budget.within([], 2.0) == []
    assert budget.within([LINE] * 9, 100.0) == [LINE] * 9


def test_a_flood_without_end_is_five_lines_a_second_and_one_about_the_others() -> None:
    budget = LogBudget()
    told: list[Event] = []
    for tick in range(1000):
        told += budget.within([LINE] * 2, 100.0 + tick / 100)
    lines = told.count(LINE)
    assert 20 + 9 * 5 <= lines <= 20 + 10 * 5
    assert len(told) - lines in (9, 10)


def test_everything_but_log_lines_is_passed_on_in_its_order() -> None:
    first, last = Message(125, b""), Message(126, b"hit")
    events: list[Event] = [first, *[LINE] * 500, last]
    assert LogBudget().within(events, 0.0) == [first, *[LINE] * BURST, last]
