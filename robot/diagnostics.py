"""The serial line for the tools that watch a ROS system: /diagnostics, where Debian's python3-diagnostic-msgs is
installed."""

from dataclasses import dataclass

import rospy

try:
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
except ImportError:  # a robot does not need it
    DiagnosticArray = None


@dataclass(frozen=True)
class LineState:
    """The conversation with the device, at one moment."""

    silence: float | None  # s since its last sign of life; None: none yet
    mute: bool  # it should have spoken by now
    broken_frames: int
    stray_bytes: int
    dropped_answers: int  # for which the line had no room


class Diagnostics:
    def __init__(self, device: str) -> None:
        self._device = device
        self._publisher = DiagnosticArray and rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=1)

    def publish(self, state: LineState) -> None:
        if self._publisher:
            array = DiagnosticArray(status=[status(state, rospy.get_name(), self._device)])
            array.header.stamp = rospy.Time.now()
            self._publisher.publish(array)


def status(state: LineState, node: str, device: str) -> "DiagnosticStatus":
    """As a DiagnosticStatus: an error while the device is silent, a warning when the line has lost something."""
    if state.silence is None:
        level, message = DiagnosticStatus.ERROR, "the device has not answered yet"
    elif state.mute:
        level, message = DiagnosticStatus.ERROR, f"the device is silent for {state.silence:.1f} s"
    elif state.broken_frames or state.dropped_answers:
        level, message = DiagnosticStatus.WARN, "the line has lost frames"
    else:
        level, message = DiagnosticStatus.OK, "the device answers"
    values = {
        "seconds since the last sign of the device": "none" if state.silence is None else f"{state.silence:.1f}",
        "broken frames": f"{state.broken_frames}",
        "stray bytes": f"{state.stray_bytes}",
        "answers dropped": f"{state.dropped_answers}",
    }
    return DiagnosticStatus(
        level=level,
        name=f"{node.lstrip('/')}: serial line",
        message=message,
        hardware_id=device,
        values=[KeyValue(key, value) for key, value in values.items()],
    )
