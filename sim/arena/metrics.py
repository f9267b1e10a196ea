"""What the arena tells those who watch it (docs/monitoring.md). Pure."""

from collections.abc import Iterable

from prometheus_client.core import CounterMetricFamily, Metric

from laser_bot_battle.watched import gauge, labelled
from sim.arena.world import World


def metrics(world: World, viewers: int) -> Iterable[Metric]:
    robots = world.robots.values()
    return [
        gauge("laserbot_arena_robots", "Virtual robots on the floor.", len(robots)),
        gauge(
            "laserbot_arena_viewers",
            "Clients of the virtual arena's own view: developers' pages and sim.positions.",
            viewers,
        ),
        labelled(
            CounterMetricFamily,
            "laserbot_arena_hits_total",
            "Times that light of others has met the virtual robot.",
            ["robot"],
            {(robot.name,): robot.hits for robot in robots},
        ),
    ]
