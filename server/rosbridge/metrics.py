"""What rosbridge tells those who watch it (docs/monitoring.md). Pure."""

import math
from bisect import bisect_left
from collections.abc import Iterable

from prometheus_client.core import CounterMetricFamily, HistogramMetricFamily, Metric

from laser_bot_battle.watched import counter, gauge, labelled
from server.rosbridge.drivers import Drivers
from server.rosbridge.gate import REFEREE_SILENCE, Gate

STEPS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)  # s


class Delays:
    """How often something took how long."""

    def __init__(self) -> None:
        self._counts = [0] * (len(STEPS) + 1)
        self._total = 0.0

    def add(self, seconds: float) -> None:
        self._counts[bisect_left(STEPS, seconds)] += 1
        self._total += seconds

    def histogram(self, name: str, text: str) -> Metric:
        reached, buckets = 0, []
        for step, count in zip((*STEPS, math.inf), self._counts, strict=True):
            reached += count
            buckets.append(("+Inf" if step == math.inf else str(step), float(reached)))
        return HistogramMetricFamily(name, text, buckets=buckets, sum_value=self._total)


def missing(gate: Gate, now: float) -> str:
    """Why nobody can drive; "" if the players of a battle can."""
    return "nothing heard from the referee" if gate.silence(now) > REFEREE_SILENCE else ""


def metrics(clients: int, gate: Gate, drivers: Drivers, delays: Delays, now: float) -> Iterable[Metric]:
    return [
        gauge("laserbot_rosbridge_clients", "Open WebSockets of pages, bots and others.", clients),
        counter("laserbot_commands_total", "Commands for robots that clients have published.", drivers.commands),
        delays.histogram(
            "laserbot_command_seconds",
            "Age of a command when rosbridge gives it to ROS: since the turn of the event loop that has read it, whose "
            "clock counts whole ms.",
        ),
        labelled(
            CounterMetricFamily,
            "laserbot_refusals_total",
            "Requests of clients that the gate has refused.",
            ["operation"],
            {(operation,): count for operation, count in gate.refusals.items()},
        ),
        gauge("laserbot_referee_silence_seconds", "Time since the last /game_status; +Inf: none.", gate.silence(now)),
    ]
