"""What the cameras' relay tells those who watch it (docs/monitoring.md). Pure."""

from collections import Counter
from collections.abc import Collection, Iterable

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric

from laser_bot_battle.names import ABOVE
from laser_bot_battle.watched import counter, gauge, labelled
from server.camera.camera import LIVE, NONE, WAITING, Camera


class Traffic:
    """What has passed since the program's start."""

    def __init__(self) -> None:
        self.received = self.sent = self.sent_bytes = 0


def metrics(viewers: int, cameras: Collection[Camera], traffic: Traffic, now: float) -> Iterable[Metric]:
    """`now` is Unix time in s."""
    states = Counter(camera.state for camera in cameras)
    ages = {
        "above" if each.robot == ABOVE else str(each.robot): now - each.picture.taken
        for each in cameras
        if each.picture is not None
    }
    return [
        gauge("laserbot_relay_viewers", "Open WebSockets of those who may look through cameras.", viewers),
        labelled(
            GaugeMetricFamily,
            "laserbot_relay_cameras",
            "Cameras that somebody looks through: live, waiting (cannot be reached), none (the robot has none).",
            ["state"],
            {(state,): states[state] for state in (LIVE, WAITING, NONE)},
        ),
        labelled(
            CounterMetricFamily,
            "laserbot_frames_total",
            "Pictures received from cameras, and sent to viewers.",
            ["way"],
            {("received",): traffic.received, ("sent",): traffic.sent},
        ),
        counter("laserbot_frames_bytes_total", "Bytes of the pictures sent.", traffic.sent_bytes),
        labelled(
            GaugeMetricFamily,
            "laserbot_frame_age_seconds",
            "Time since the newest picture of a camera was taken, by the robot's clock as the relay knows it.",
            ["robot"],
            {(robot,): max(0.0, age) for robot, age in ages.items()},
        ),
    ]
