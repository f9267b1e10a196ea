"""Containers, images, engine."""

import json
import re
import shlex

from fleet import Fleet, Machine, until


def test_every_service_is_healthy(machine: Machine) -> None:
    for service in machine.services:
        until(lambda s=service: machine.container(s)["State"]["Health"]["Status"] == "healthy", 60, service)


def test_images_are_named_by_digest_and_remembered(machine: Machine) -> None:
    release = json.loads(machine.run("cat /etc/laserbot/release.json"))
    for service in machine.services:
        image = machine.container(service)["Config"]["Image"]
        assert re.fullmatch(r"laser-bot-master\.local:5443/\w+@sha256:[0-9a-f]{64}", image)
        assert image == release["current"]


def test_the_image_is_of_its_platform(robot: Machine) -> None:
    architectures = {"amd64": "linux/amd64", "arm64": "linux/arm64", "armhf": "linux/arm/v7"}
    wanted = robot.platform or architectures[robot.run("dpkg --print-architecture").strip()]
    kind = '{{.Os}}/{{.Architecture}}{{if eq .Architecture "arm"}}/{{.Variant}}{{end}}'
    image = robot.container("laserbot-robot")["Image"]
    assert robot.run(f"docker image inspect --format {shlex.quote(kind)} {image}").strip() == wanted


def test_containers_are_kept_in(machine: Machine) -> None:
    for service in machine.services:
        settings = machine.container(service)["HostConfig"]
        assert settings["ReadonlyRootfs"] is True
        assert settings["CapDrop"] == ["ALL"]
        assert not settings["CapAdd"]
        assert not settings["Privileged"]
        assert "no-new-privileges" in str(settings["SecurityOpt"])
        assert settings["RestartPolicy"]["Name"] == "unless-stopped"
        assert settings["LogConfig"]["Config"].keys() == {"max-size", "max-file"}, "its log is bounded"


def test_no_program_of_the_game_is_root(machine: Machine) -> None:
    def users(service: str) -> set[str]:
        return {line.split()[1] for line in machine.run(f"docker top {service} -o pid,uid").splitlines()[1:]}

    for service in machine.services:
        # the engine's own helper, which starts a health check, is root for a moment
        until(lambda s=service: users(s) == {"10001"}, 10, service)


def test_the_engine_keeps_containers_through_its_own_restart(machine: Machine) -> None:
    assert machine.run("docker info --format '{{.LiveRestoreEnabled}}'").strip() == "true"


def test_engine_and_firewall_start_at_boot(machine: Machine) -> None:
    for unit in ("docker", "laserbot-firewall", "laserbot-revive", "avahi-daemon", "chrony", "ssh"):
        assert machine.host.service(unit).is_enabled, unit
        assert machine.host.service(unit).is_running, unit
    assert machine.run("systemctl --failed --plain --no-legend") == ""


def test_the_registry_wants_a_password(machine: Machine) -> None:
    ask = (
        "import ssl,urllib.request as r;"
        "c=ssl.create_default_context(cafile='/etc/docker/certs.d/laser-bot-master.local:5443/ca.crt');"
def test_the_game_is_at_one_address(master: Machine) -> None:
    """By TLS if it has a certificate; the authority's own comes without."""
    kind = "https" if master.tls else "http"
    ask = (
        "import ssl,urllib.request as r;"
        f"print(r.urlopen('http://{master.address}/',timeout=5,context=ssl._create_unverified_context()).url)"
    )
    assert master.run(f'python3 -c "{ask}"').startswith(f"{kind}://{master.address}/")


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
