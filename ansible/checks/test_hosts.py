"""Names, time, devices, users, secrets, firewall."""

import re
import shlex
import subprocess
from collections.abc import Callable

import pytest

from fleet import Fleet, Machine, until

SECRETS_OF_ALL = ("/root/.docker/config.json",)
TLS_KEY = "/etc/laserbot/tls/front.key"
SECRETS_OF_THE_MASTER = (
    "/etc/laserbot/ca/ca.key",
    "/etc/laserbot/operator-token",
    "/etc/docker/registry/htpasswd",
    "/etc/docker/registry/tls/registry.key",
)


def names(fleet: Fleet) -> dict[str, str]:
    """Every name of the fleet, and its address."""
    of_the_master = dict.fromkeys(("laser_bot_master.local", "laser-bot-master.local"), fleet.master.address)
    return of_the_master | {f"{robot.name}.local": robot.address for robot in fleet.robots}


def names_of_others(fleet: Fleet, machine: Machine) -> dict[str, str]:
    """A host may give its own name another of its addresses."""
    return {name: address for name, address in names(fleet).items() if address != machine.address}


def test_names_are_known_on_every_host(fleet: Fleet, machine: Machine) -> None:
    asked = names_of_others(fleet, machine)
    found = machine.run(f"for name in {' '.join(asked)}; do getent ahostsv4 $name | head -n 1; done").splitlines()
    assert [line.split()[0] for line in found] == list(asked.values())


def test_names_are_known_inside_containers(fleet: Fleet, machine: Machine) -> None:
    asked = names_of_others(fleet, machine)
    ask = f"import socket;print(*map(socket.gethostbyname,{list(asked)}))"
    for service, found in machine.run_in_containers(f'python3 -c "{ask}"').items():
        assert found.split() == list(asked.values()), service


def test_names_are_not_waited_for(fleet: Fleet, machine: Machine) -> None:
    """No DNS server is asked about them: in a LAN without internet it would be silent for 5 s, each time."""
    name = "laser_bot_master.local" if machine.group == "robots" else f"{fleet.robots[0].name}.local"
    lookups = f"[socket.getaddrinfo('{name}', 1) for _ in range(5)]"
    ask = f"import socket, time; began = time.monotonic(); {lookups}; print(time.monotonic() - began)"
    for where in ("", f"docker exec {machine.services[0]} "):
        assert float(machine.run(f'{where}python3 -c "{ask}"')) < 5.0, where


def test_the_game_is_announced(fleet: Fleet, machine: Machine) -> None:
    def found() -> bool:
        lines = machine.run("avahi-browse --resolve --parsable --terminate _laserbot._tcp").splitlines()
        resolved = [line.split(";", 9) for line in lines if line.startswith("=")]
        texts = [line[9] for line in resolved if line[7:9] == [fleet.master.address, "5000"]]
        return any('"rosbridge=9090"' in text and '"ros=11311"' in text for text in texts)

    until(found, 15, "_laserbot._tcp of the master")


def test_a_robot_finds_the_master_by_its_arenas_name(fleet: Fleet, robot: Machine) -> None:
    if any(setting.startswith("LASERBOT_MASTER=") for setting in robot.container("laserbot-robot")["Config"]["Env"]):
        pytest.skip("it was told where the master is")
    found = robot.run("docker exec laserbot-robot python3 -m robot.find").splitlines()
    assert any(fleet.master.arena in line for line in found), found
    assert any(fleet.master.address in line for line in found), found


def test_apt_knows_which_security_updates_are_open(
    machine: Machine, record_property: Callable[[str, object], None]
) -> None:
    """As of the host's last `apt-get update`, of each day where it reaches an archive. A kernel's is a new package."""
    lines = machine.run("LC_ALL=C apt-get --simulate -o Debug::NoLocking=true upgrade --with-new-pkgs").splitlines()
    assert any("not upgraded" in line for line in lines), lines
    updates = [line.split()[1] for line in lines if line.startswith("Inst ") and "Debian-Security:" in line]
    if updates:
        record_property("open security updates", " ".join(updates))


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
    if robot.serial == "/dev/laserbot":
        assert robot.host.file(robot.serial).is_symlink
    device = robot.run(f"stat -L -c '%F %G %a' {robot.serial}").strip()
    assert device == "character special file dialout 660"


def test_a_host_has_its_name(machine: Machine) -> None:
    """systemd's: it allows no underscore, with which the master is announced."""
    assert machine.run("hostname").strip() == ("laser-bot-master" if machine.group == "master" else machine.name)


def test_a_host_that_crashes_or_hangs_restarts(machine: Machine) -> None:
    """Both settings are the kernel's: a host that shares it has neither."""
    shared = machine.host.run("systemd-detect-virt --container --quiet").rc == 0
    wanted = machine.run("cat /etc/systemd/system.conf.d/laserbot.conf").rpartition("=")[2].strip()
    assert wanted == "0" or not shared
    manager = "org.freedesktop.systemd1 /org/freedesktop/systemd1 org.freedesktop.systemd1.Manager"
    assert machine.run(f"busctl get-property {manager} RuntimeWatchdogUSec").split() == ["t", f"{int(wanted) * 10**6}"]
    assert shared or machine.run("sysctl --values kernel.panic kernel.panic_on_oops").split() == ["10", "1"]


def test_ssh_wants_a_key(machine: Machine) -> None:
    """By its settings, and in the words of the one that runs."""
    # the first value of an option counts
    log_in = ["ssh", "-o", "ControlPath=none", *shlex.split(machine.ssh), "-o", "PreferredAuthentications=none"]
    log_in += [f"{machine.user}@{machine.address}", "true"]
    refused = subprocess.run(log_in, capture_output=True, text=True, timeout=20, check=False).stderr
    assert "Permission denied (publickey)." in refused
    settings = machine.run("sshd -T")
    assert "passwordauthentication no" in settings
    assert "kbdinteractiveauthentication no" in settings
    assert "permitrootlogin no" in settings
    (root,) = [line for line in machine.run("cat /etc/shadow").splitlines() if line.startswith("root:")]
    assert root.split(":")[1].startswith(("!", "*")), "root has a password"


def test_the_firewall_is_in_effect(machine: Machine) -> None:
    rules = machine.run("nft list table inet laserbot")
    assert "policy drop" in rules
    (ports,) = re.findall(r"tcp dport (\S+|{ .* }) accept comment \"players\"", rules) or [""]
    game = (80, 443, 5000, 9090, 9091) if machine.group == "master" else ()
    assert sorted(map(int, re.findall(r"\d+", ports))) == sorted({*game, *machine.open_ports})
    # the engine's own are still there
    assert "DOCKER" in machine.run("nft list ruleset")


def test_secret_files_are_nobody_elses(machine: Machine) -> None:
    wanted = {*SECRETS_OF_ALL, *(SECRETS_OF_THE_MASTER if machine.group == "master" else ())}
    if machine.tls:
        wanted.add(TLS_KEY)
    looked_for = " ".join((*SECRETS_OF_ALL, *SECRETS_OF_THE_MASTER, TLS_KEY))
    found = dict(line.split() for line in machine.host.run(f"stat --format '%n %a' {looked_for}").stdout.splitlines())
    assert set(found) == wanted
    assert not [path for path, mode in found.items() if int(mode, 8) & 0o007]
    assert machine.host.run(f"sudo -u nobody cat {looked_for} 2>/dev/null").stdout == ""


def test_no_secret_is_shown(fleet: Fleet, machine: Machine) -> None:
    """Neither in the process list nor in the containers' settings nor in the journal."""
    token = fleet.master.run("cat /etc/laserbot/operator-token").strip()
    assert machine.registry_password
    secrets = "\n".join(filter(None, (token, machine.registry_password)))
    shown = ("ps axeww -o args", "docker inspect $(docker ps -q)", "journalctl --no-pager --output=cat")
    look = f"grep --files-with-matches --fixed-strings --file=- {' '.join(f'<({command})' for command in shown)}"
    # by standard input: sudo writes commands into the journal
    ssh = ["ssh", *shlex.split(machine.ssh), f"{machine.user}@{machine.address}"]
    found = subprocess.run(
        [*ssh, f"sudo bash -c {shlex.quote(look)}"], input=secrets, capture_output=True, text=True, check=False
    )
    assert (found.returncode, found.stdout) == (1, ""), f"one of {shown}: {found.stderr}"
