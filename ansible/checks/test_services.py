"""Containers, images, engine."""

import json
import re
import shlex
from collections.abc import Callable
from typing import Any

import pytest

from fleet import Fleet, Machine, until


def test_every_service_is_healthy(machine: Machine, record_property: Callable[[str, object], None]) -> None:
    if machine.left_out:
        record_property("its release has no", " ".join(machine.left_out))

    def healthy() -> bool:
        return {each["State"]["Health"]["Status"] for each in machine.containers().values()} == {"healthy"}

    until(healthy, 60, "all services healthy")


def test_images_are_named_by_digest_and_remembered(machine: Machine) -> None:
    release = json.loads(machine.run("cat /etc/laserbot/release.json"))
    for container in machine.containers().values():
        image = container["Config"]["Image"]
        assert re.fullmatch(r"laser-bot-master\.local:5443/\w+@sha256:[0-9a-f]{64}", image)
        assert image == release["current"]


def test_the_image_is_of_its_platform(robot: Machine) -> None:
    architectures = {"amd64": "linux/amd64", "arm64": "linux/arm64", "armhf": "linux/arm/v7"}
    wanted = robot.platform or architectures[robot.run("dpkg --print-architecture").strip()]
    kind = '{{.Os}}/{{.Architecture}}{{if eq .Architecture "arm"}}/{{.Variant}}{{end}}'
    image = robot.container("laserbot-robot")["Image"]
    assert robot.run(f"docker image inspect --format {shlex.quote(kind)} {image}").strip() == wanted


def test_containers_are_kept_in(machine: Machine) -> None:
    for container in machine.containers().values():
        settings = container["HostConfig"]
        assert settings["ReadonlyRootfs"] is True
        assert settings["CapDrop"] == ["ALL"]
        assert not settings["CapAdd"]
        assert not settings["Privileged"]
        assert "no-new-privileges" in str(settings["SecurityOpt"])
        assert settings["RestartPolicy"]["Name"] == "unless-stopped"
        assert settings["LogConfig"]["Type"] == "journald", "its log is bounded"


def test_no_program_of_the_game_is_root(machine: Machine) -> None:
    def users() -> set[str]:
        look = f"for s in {' '.join(machine.running)}; do docker top $s -o pid,uid | tail --lines=+2; done"
        return {line.split()[1] for line in machine.run(look).splitlines()}

    # the engine's own helper, which starts a health check, is root for a moment
    until(lambda: users() == {"10001"}, 10, "no other user")


def test_the_engine_keeps_containers_through_its_own_restart(machine: Machine) -> None:
    assert machine.run("docker info --format '{{.LiveRestoreEnabled}}'").strip() == "true"


def test_engine_and_firewall_start_at_boot(machine: Machine) -> None:
    units = "docker laserbot-firewall laserbot-revive avahi-daemon chrony ssh"
    assert set(machine.run(f"systemctl is-enabled {units}").split()) == {"enabled"}
    assert set(machine.run(f"systemctl is-active {units}").split()) == {"active"}
    assert machine.run("systemctl --failed --plain --no-legend") == ""


def test_the_game_is_at_one_address(master: Machine) -> None:
    """By TLS if it has a certificate; the authority's own comes without."""
    kind = "https" if master.tls else "http"
    ask = (
        "import ssl,urllib.request as r;"
        f"print(r.urlopen('http://{master.address}/',timeout=5,context=ssl._create_unverified_context()).url)"
    )
    assert master.run(f'python3 -c "{ask}"').startswith(f"{kind}://{master.address}/")


def test_prometheus_sees_the_masters_programs(master: Machine) -> None:
    if not master.monitoring:
        pytest.skip("nobody watches this master")

    ask = "import urllib.request as r;print(r.urlopen('http://127.0.0.1:{}',timeout=5).read().decode())"

    def answer(place: str) -> Any:
        return json.loads(master.run(f'python3 -c "{ask.format(place)}"'))

    def up() -> set[str]:
        series = answer("9210/api/v1/query?query=up")["data"]["result"]
        return {each["metric"]["program"] for each in series if each["value"][1] == "1"}

    # it asks for a tracker also where there is no camera above the floor
    wanted = {"web", "rosbridge", "relay"} | ({"overhead"} if master.overhead else set())
    until(lambda: up() == wanted, 30, "all programs are up")
    assert answer("9211/api/v2/status")["config"], "Alertmanager answers"


def test_the_master_has_the_robots_logs(fleet: Fleet, robot: Machine) -> None:
    if int(fleet.master.run("systemctl --version").split()[1]) < 253:
        pytest.skip("Debian 12's master keeps none")
    robot.run("logger --tag=laserbot-check hello")
    look = "journalctl --directory=/var/log/journal/remote --since=-1min --identifier=laserbot-check --quiet"
    until(lambda: fleet.master.host.run(f"{look} _HOSTNAME={robot.name}").stdout != "", 30, "the line has come")


def test_the_registry_wants_a_password(machine: Machine) -> None:
    ask = (
        "import ssl,urllib.request as r;"
        "c=ssl.create_default_context(cafile='/etc/docker/certs.d/laser-bot-master.local:5443/ca.crt');"
        "r.urlopen('https://laser-bot-master.local:5443/v2/rosberry/tags/list',context=c,timeout=10)"
    )
    answer = machine.host.run(f'python3 -c "{ask}"')
    assert answer.rc != 0
    assert "HTTP Error 401" in answer.stderr
    # without the login that root has
    pull = machine.host.run("DOCKER_CONFIG=/nonexistent docker pull laser-bot-master.local:5443/rosberry:latest")
    assert pull.rc != 0
    assert "no basic auth credentials" in pull.stderr


def test_robots_are_registered(fleet: Fleet, master: Machine) -> None:
    """Every robot is either free or a player's."""
    ask = "import urllib.request as r;print(r.urlopen('http://localhost:5000/{}',b'',timeout=5).read().decode())"

    def registered() -> int:
        free = json.loads(master.run(f'python3 -c "{ask.format("getAvailableRobots")}"'))["availableR"]
        status = json.loads(master.run(f'python3 -c "{ask.format("updateGameStatus")}"'))
        return int(free) + len(json.loads(status["users"]))

    until(lambda: registered() == len(fleet.robots), 30, "all robots at the server")
