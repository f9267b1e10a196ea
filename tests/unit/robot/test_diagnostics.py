import dataclasses
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus

from robot.diagnostics import LineState, status

GOOD = LineState(silence=1.2, mute=False, broken_frames=0, stray_bytes=3, dropped_answers=0)


@pytest.mark.parametrize(
    ("changes", "level", "message"),
    [
        ({}, DiagnosticStatus.OK, "the device answers"),
        ({"broken_frames": 1}, DiagnosticStatus.WARN, "the line has lost frames"),
        ({"dropped_answers": 1}, DiagnosticStatus.WARN, "the line has lost frames"),
        ({"silence": 4.0, "mute": True}, DiagnosticStatus.ERROR, "the device is silent for 4.0 s"),
        ({"silence": None}, DiagnosticStatus.ERROR, "the device has not answered yet"),
    ],
)
def test_the_level_says_how_bad_it_is(changes: dict[str, Any], level: int, message: str) -> None:
    told = status(dataclasses.replace(GOOD, **changes), "/Robot0", "/dev/ttyACM0")
    assert (told.name, told.hardware_id) == ("Robot0: serial line", "/dev/ttyACM0")
    assert (told.level, told.message) == (level, message)


def test_the_values_are_told() -> None:
    told = {value.key: value.value for value in status(GOOD, "/Robot0", "x").values}
    assert told["seconds since the last sign of the device"] == "1.2"
    assert told["stray bytes"] == "3"
