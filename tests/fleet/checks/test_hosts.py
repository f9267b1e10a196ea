"""Names, time, devices, users, secrets, firewall."""

import re

from tests.support.fleet import Fleet, Machine
from tests.support.polling import until

SECRETS_OF_ALL = ("/root/.docker/config.json",)
SECRETS_OF_THE_MASTER = (
    "/etc/laserbot/ca/ca.key",
    "/etc/laserbot/operator-token",
    "/etc/docker/registry/htpasswd",
    "/etc/docker/registry/tls/registry.key",
)
NAMES = ("laser_bot_master.local", "laser-bot-master.local")


def test_names_are_known_on_every_host(fleet: Fleet, machine: Machine) -> None:
    wanted = dict.fromkeys(NAMES, fleet.master.address) | {f"{r.name}.local": r.address for r in fleet.robots}
    for name, address in wanted.items():
        # a host may give its own name another of its addresses
        if address != machine.address:
            assert machine.run(f"getent ahostsv4 {name}").split()[0] == address, name


def test_names_are_known_inside_containers(fleet: Fleet, robot: Machine) -> None:
    for name in NAMES:
        ask = f"import socket;print(socket.gethostbyname('{name}'))"
        assert robot.run(f'docker exec laserbot-robot python3 -c "{ask}"').strip() == fleet.master.address


def test_the_game_is_announced(fleet: Fleet, machine: Machine) -> None:
    def found() -> bool:
        lines = machine.run("avahi-browse --resolve --parsable --terminate _laserbot._tcp").splitlines()
        resolved = [line.split(";") for line in lines if line.startswith("=")]
        return any(line[7:9] == [fleet.master.address, "5000"] for line in resolved)

    until(found, 15, "_laserbot._tcp of the master")


def test_the_clocks_agree(fleet: Fleet, machine: Machine) -> None:
    def synchronised() -> bool:
        tracking = machine.run("chronyc -n tracking")
        source = machine.group == "master" or fleet.master.address in tracking
        return source and "Leap status     : Normal" in tracking

    until(synchronised, 60, "chrony has found its source")
    offset = re.search(r"System time\s+: ([0-9.]+) seconds", machine.run("chronyc -n tracking"))
    assert offset
    assert float(offset[1]) < 0.5


def test_the_arduino_has_its_name(robot: Machine) -> None:
    if int(robot.run("udevadm --version")) >= 254:  # the first that knows this verb
        robot.run("udevadm verify /etc/udev/rules.d/60-laserbot.rules")
    assert robot.host.file("/dev/laserbot").is_symlink
    device = robot.run("stat -L -c '%F %G %a' /dev/laserbot").strip()
    assert device == "character special file dialout 660"


def test_ssh_wants_a_key(machine: Machine) -> None:
    settings = machine.run("sshd -T")
    assert "passwordauthentication no" in settings
    assert "kbdinteractiveauthentication no" in settings
    assert "permitrootlogin no" in settings
    (root,) = [line for line in machine.run("cat /etc/shadow").splitlines() if line.startswith("root:")]
    assert root.split(":")[1].startswith(("!", "*")), "root has a password"


def test_the_firewall_is_in_effect(machine: Machine) -> None:
    rules = machine.run("nft list table inet laserbot")
    assert "policy drop" in rules
    assert ("dport { 5000, 9090 }" in rules) == (machine.group == "master")
    # the engine's own are still there
    assert "DOCKER" in machine.run("nft list ruleset")


def test_secret_files_are_nobody_elses(machine: Machine) -> None:
    for path in (*SECRETS_OF_ALL, *SECRETS_OF_THE_MASTER):
        file = machine.host.file(path)
        if machine.group != "master" and path in SECRETS_OF_THE_MASTER:
            assert not file.exists, path
            continue
        assert file.mode & 0o007 == 0, f"{path} {file.mode:o}"
        assert machine.host.run(f"sudo -u nobody cat {path}").rc != 0, path


def test_no_secret_is_shown(fleet: Fleet, machine: Machine) -> None:
    """Neither in the process list nor in the containers' settings nor in the journal."""
    token = fleet.master.run("cat /etc/laserbot/operator-token").strip()
    assert machine.registry_password
    for secret in filter(None, (token, machine.registry_password)):
        for shown in ("ps axeww -o args", "docker inspect $(docker ps -q)", "journalctl --no-pager"):
            assert secret not in machine.run(shown), shown
