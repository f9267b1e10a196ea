"""A battle that is watched: what its programs tell, as the documents say, and what Prometheus makes of it."""

import json
import socket
import subprocess
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import psutil
import pytest
import requests
import yaml
from prometheus_client.parser import text_string_to_metric_families

from laser_bot_battle.names import WATCHED
from tests.support.battle import Battle, Paused
from tests.support.documents import page, table
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program
from tests.support.viewer import Viewer

PLAYED = tuple(program for program in WATCHED if program != "overhead")  # the demo has no camera above its floor
TOLD = [row for row in table(page("monitoring.md"), "Metrics") if row["program"] in PLAYED]
# of what a machine of the tests may not have
MAY_BE_EMPTY = {"laserbot_robot_wifi_dbm"}


def ports_in_a_row() -> int:
    """The first of so many free ports: such a row is not handed out to others, but seldom taken."""
    for first in range(20_000, 30_000, len(WATCHED)):
        try:
            for port in range(first, first + len(WATCHED)):
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", port))
        except OSError:
            continue
        return first
    raise AssertionError("no free ports in a row")


Ask = Callable[[str], list[Any]]


def unpacked(package: str) -> Path:
    """Where Debian's package is, not installed: it would start its service."""
    result = subprocess.run([ROOT / "ci/unpack", package], stdout=subprocess.PIPE, text=True, check=True)
    return Path(result.stdout.strip())


class Watched(NamedTuple):
    battle: Battle
    port: int

    def get(self, program: str, path: str) -> requests.Response:
        return requests.get(f"http://127.0.0.1:{self.port + WATCHED.index(program)}{path}", timeout=LATEST)


@pytest.fixture(scope="module")
def watched() -> Iterator[Watched]:
    """Two bots fight, and somebody looks through the camera of robot 0."""
    port = ports_in_a_row()
    with Battle(robots=2, bots=2, LASERBOT_COUNTDOWN="1", LASERBOT_METRICS=f"127.0.0.1:{port}") as battle:
        yield Watched(battle, port)


def test_programs_can_be_watched_at_either_address_of_localhost(watched: Watched) -> None:
    for number in range(len(PLAYED)):
        for address in ("127.0.0.1", "[::1]"):
            assert requests.get(f"http://{address}:{watched.port + number}/healthz", timeout=LATEST).text == "ok\n"


@pytest.fixture(scope="module")
def prometheus(watched: Watched, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ask]:
    """Debian's, with the configuration that is shipped, but for its ports. Asked by a query, it answers with series."""
    folder, own = tmp_path_factory.mktemp("prometheus"), free_port()
    text = (ROOT / "monitoring/prometheus.yml").read_text().replace("5s", "1s")
    for number in range(len(WATCHED)):
        text = text.replace(f":920{number}", f":{watched.port + number}")
    (folder / "prometheus.yml").write_text(text)
    (folder / "rules.yml").write_text((ROOT / "monitoring/rules.yml").read_text())
    program = Program(
        [
            str(unpacked("prometheus") / "usr/bin/prometheus"),
            f"--config.file={folder}/prometheus.yml",
            f"--storage.tsdb.path={folder}/data",
            f"--web.listen-address=127.0.0.1:{own}",
        ]
    )
    try:
        program.wait_for("Server is ready")
        with Viewer(watched.battle.relay_port) as viewer:
            viewer.watch(0)

            def ask(query: str) -> list[Any]:
                viewer.next()  # or it would be taken for dead
                url = f"http://127.0.0.1:{own}/api/v1/query"
                answer = requests.get(url, params={"query": query}, timeout=LATEST).json()
                assert answer["status"] == "success", answer
                return list(answer["data"]["result"])

            yield ask
    finally:
        program.stop()


def test_the_programs_tell_what_the_page_says(watched: Watched) -> None:
    told = [
        {
            "metric": family.name + ("_total" if family.type == "counter" else ""),
            "program": program,
            "labels": ", ".join(labels_of(family)),
            "what": family.documentation.replace("`", ""),
        }
        for program in PLAYED
        for family in text_string_to_metric_families(watched.get(program, "/metrics").text)
        if not family.name.startswith("process_")
    ]
    for row, documented in zip(told, TOLD, strict=True):
        assert {**row, "labels": row["labels"] or documented["labels"]} == documented


def labels_of(family: Any) -> list[str]:
    """Of its samples; none if there are none."""
    return list(family.samples[0].labels) if family.samples and "le" not in family.samples[0].labels else []


@pytest.mark.slow
def test_every_query_of_the_dashboard_has_an_answer(prometheus: Ask) -> None:
    dashboard = json.loads((ROOT / "monitoring/dashboard.json").read_text())
    queries = [target["expr"] for panel in dashboard["panels"] for target in panel["targets"]]
    assert len(queries) > 20
    for query in set(queries) - MAY_BE_EMPTY:
        until(partial(prometheus, query), 30, query)


@pytest.mark.slow
def test_an_alert_names_the_robot_that_is_lost(watched: Watched, prometheus: Ask) -> None:
    lost = 'ALERTS{alertstate="firing", alertname="RobotLost"}'
    assert prometheus(lost) == []
    client = psutil.Process(watched.battle.pid(r"robot\.serial_node .*/virtual1/")).ppid()
    with Paused(client):
        until(lambda: [alert["metric"]["robot"] for alert in prometheus(lost)] == ["1"], 60, "an alert")
    until(lambda: prometheus(lost) == [], 60, "it is back")


def test_a_program_that_waits_for_the_referee_is_healthy_but_not_ready(watched: Watched) -> None:
    for program in PLAYED:
        assert watched.get(program, "/healthz").text == watched.get(program, "/readyz").text == "ok\n"

    def waits() -> bool:
        answer = watched.get("rosbridge", "/readyz")
        return (answer.status_code, answer.text) == (503, "nothing heard from the referee\n")

    with watched.battle.pause(r"server\.main"):
        until(waits, 10, "rosbridge hears nothing from the referee")
        assert watched.get("rosbridge", "/healthz").status_code == 200
    until(lambda: watched.get("rosbridge", "/readyz").status_code == 200, 10, "rosbridge hears the referee again")


@pytest.mark.slow
def test_the_alerts_come_when_they_should_and_say_what_to_do() -> None:
    promtool = unpacked("promtool") / "usr/bin/promtool"
    rules = ROOT / "monitoring/rules_test.yml"
    result = subprocess.run([promtool, "test", "rules", rules], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    for group in yaml.safe_load((ROOT / "monitoring/rules.yml").read_text())["groups"]:
        for rule in group["rules"]:
            assert rule["annotations"].keys() == {"summary", "do"}, rule["alert"]


@pytest.mark.slow
def test_prometheus_and_alertmanager_take_their_configuration() -> None:
    promtool = unpacked("promtool") / "usr/bin/promtool"
    amtool = unpacked("prometheus-alertmanager") / "usr/bin/amtool"
    for command in (
        f"{promtool} check config {ROOT / 'monitoring/prometheus.yml'}",
        f"{amtool} check-config {ROOT / 'monitoring/alertmanager.yml'}",
    ):
        result = subprocess.run(command.split(), capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.slow
@pytest.mark.parametrize(("alert", "receiver"), [("Watchdog", "watchdog"), ("RobotLost", "operators")])
def test_what_is_always_there_goes_elsewhere_than_what_is_wrong(alert: str, receiver: str) -> None:
    amtool = unpacked("prometheus-alertmanager") / "usr/bin/amtool"
    words = f"config routes test --config.file={ROOT / 'monitoring/alertmanager.yml'} alertname={alert}"
    result = subprocess.run([amtool, *words.split()], capture_output=True, text=True, check=True)
    assert result.stdout.split() == [receiver]
