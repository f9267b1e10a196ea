"""What the web server tells those who watch it (docs/monitoring.md): the game, and the robots as they say they are."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric

from laser_bot_battle.watched import counter, gauge, labelled
from server.game.loop import GameLoop
from server.game.robot_health import WARNINGS, Report, RobotsHealth
from server.store.database import Database


class Reading(NamedTuple):
    """A figure out of a robot's report. Without one, or with the 0 that stands for unknown, there is no figure."""

    name: str
    text: str
    field: str
    scale: float = 1.0
    kind: type[GaugeMetricFamily] | type[CounterMetricFamily] = GaugeMetricFamily


OF_THE_PI = (
    Reading("cpu", "Load of the Raspberry Pi, 0 to 1 of all cores.", "cpu"),
    Reading("temperature_celsius", "Temperature of the Raspberry Pi's chip.", "temperature"),
    Reading("wifi_dbm", "Wi-Fi signal of the robot.", "wifi"),
)
OF_THE_BOARD = (
    Reading("supply_volts", "Supply of the Arduino, by its own reference: 10 % exact.", "supply", 1e-3),
    Reading("battery_volts", "Battery, where a divider is on A0.", "battery", 1e-3),
    Reading("round_trip_seconds", "Serial line: from the Arduino's last question to its answer.", "round_trip", 1e-6),
    Reading("loop_max_seconds", "Longest turn of the firmware in the last second.", "loop_max", 1e-6),
)
COUNTED_BY_THE_BOARD = tuple(
    Reading(f"{name}_total", text, name, kind=CounterMetricFamily)
    for name, text in (
        ("serial_errors", "Frames with a wrong checksum that the Arduino got. Here and below, it stops at 65535."),
        ("resyncs", "Times that the Arduino has searched for the start of a frame."),
        ("overruns", "Bytes that the Arduino lost."),
        ("packets", "Good packets of coded light."),
        ("bad_packets", "Broken packets of coded light."),
        ("shots", "Shots fired."),
    )
)


def metrics(
    game: GameLoop, health: RobotsHealth, hits: Mapping[tuple[str, ...], int], refused: int, database: Database
) -> Iterable[Metric]:
    """`hits` by light and whether they count; `refused` of them by the line of fire."""
    now, overview = game.snapshot(), game.overview()
    yield gauge("laserbot_game_state", "0 stopped, 1 countdown, 2 a battle runs.", now.game.value)
    yield counter("laserbot_battles_total", "Battles begun since there is this database.", now.battle)
    yield gauge("laserbot_players", "People and bots that are signed in.", len(now.players))
    yield gauge("laserbot_queue", "Those who wait for a robot.", len(now.queue))
    yield gauge("laserbot_robots", "Registered robots.", len(now.robots))
    yield gauge("laserbot_robots_free", "Robots that the next players would get.", len(now.free_robots))
    yield labelled(
        CounterMetricFamily,
        "laserbot_hits_total",
        "Hits that robots have reported, by kind of light and whether they count by the rules.",
        ["light", "counts"],
        hits,
    )
    yield counter(
        "laserbot_hits_refused_total",
        "Coded hits that do not count, as the shooter was not in the line of fire.",
        refused,
    )
    yield gauge("laserbot_database_up", "1: the database takes what is decided.", not database.problem)
    yield counter(
        "laserbot_database_replacements_total",
        "Times that the database's file was deleted, replaced or overwritten while it was open.",
        database.replacements,
    )
    yield labelled(
        GaugeMetricFamily,
        "laserbot_robot_left",
        "1: its program has ended in order in the last 15 min, as when it is switched off or scaled down.",
        ["robot"],
        {(str(robot),): 1 for robot in game.robots_left()},
    )
    yield from _robots(overview["robots"], {robot: health.of(robot) for robot in now.robots})


def _robots(known: Iterable[Mapping[str, Any]], reports: Mapping[int, Report | None]) -> Iterable[Metric]:
    here = {(str(robot["id"]),): robot for robot in known if robot["ping_age"] is not None}
    heard = {(str(robot),): report for robot, report in reports.items() if report is not None}
    boards = {of: report["board"] for of, report in heard.items() if report["board"] is not None}

    def robots(name: str, text: str, values: Mapping[tuple[str, ...], float]) -> Metric:
        return labelled(GaugeMetricFamily, f"laserbot_robot_{name}", text, ["robot"], values)

    yield robots(
        "linked", "1: it is on its topics, and can be driven.", {of: robot["linked"] for of, robot in here.items()}
    )
    yield robots("ping_age_seconds", "Time since its last ping.", {of: robot["ping_age"] for of, robot in here.items()})
    yield robots(
        "report_age_seconds",
        "Time since its last word on /Robot<ID>/health.",
        {of: r["age"] for of, r in heard.items()},
    )
    yield labelled(
        GaugeMetricFamily,
        "laserbot_robot_warning",
        "1: the operator's desk warns of it.",
        ["robot", "warning"],
        {(*of, warning): warning in report["warnings"] for of, report in heard.items() for warning in WARNINGS},
    )
    for sources, readings in ((heard, OF_THE_PI), (boards, OF_THE_BOARD + COUNTED_BY_THE_BOARD)):
        for reading in readings:
            values = {of: source[reading.field] * reading.scale for of, source in sources.items()}
            known_values: dict[tuple[str, ...], float] = {
                of: v for of, v in values.items() if v or reading.kind is CounterMetricFamily
            }
            yield labelled(reading.kind, f"laserbot_robot_{reading.name}", reading.text, ["robot"], known_values)
