"""Playbooks on a fleet that is deployed: what is as it should be stays untouched, what is not is mended."""

import json
import re
import subprocess
import tarfile
from pathlib import Path

import pytest

from fleet import Machine
from tests.support.card import packages, settings
from tests.support.containers import execute
from tests.support.play import obeys, start
from tests.support.player import Eyes, Player
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.rehearsal import SSH, Rehearsal, copy_into, outside, power_off, power_on
from tests.support.sockets import connect

pytestmark = pytest.mark.slow


def test_a_host_that_would_be_locked_out_is_left_alone(rehearsal: Rehearsal) -> None:
    """The firewall would close SSH for the machine that deploys."""
    variables = json.dumps({"fleet_control_networks": ["192.0.2.0/24"]})
    run = rehearsal.playbook("deploy", f"--extra-vars={variables}", "--limit=raspberrypi1", check=False)
    assert "lock itself out" in run.output
    assert run.recap["raspberrypi1"]["failed"] == 1
    assert rehearsal.robots[0].run("true") == ""
    assert rehearsal.playbook("deploy", "--limit=raspberrypi1").changed == 0, "nothing had been changed"


def test_a_host_with_ssh_at_another_port_is_left_alone(rehearsal: Rehearsal) -> None:
    """The firewall opens port 22 only."""
    robot = rehearsal.robots[0]
    way = f"ssh {SSH} -W 127.0.0.1:2222 pi@{robot.address}"
    variables = {
        "ansible_port": 2222,
        "ansible_ssh_common_args": f"{SSH} -o HostKeyAlias={robot.address} -o ProxyCommand='{way}'",
        "fleet_control_networks": ["127.0.0.0/8"],  # that is not the obstacle
    }
    robot.run("systemd-run --unit=second-sshd /usr/sbin/sshd -D -p 2222")
    try:
        run = rehearsal.playbook("deploy", f"--extra-vars={json.dumps(variables)}", "--limit=raspberrypi1", check=False)
    finally:
        robot.run("systemctl stop second-sshd")
    assert "to port 2222: it would lock itself out" in run.output
    assert run.changed == 0


def test_a_robot_that_is_off_and_known_by_name_stops_a_deploy_but_no_update(
    rehearsal: Rehearsal, tmp_path: Path
) -> None:
    """Without its address the firewall would keep it out, unless the operator says who may come in."""
    more = tmp_path / "more.yml"
    more.write_text("robots: {hosts: {raspberrypi9: {ansible_host: raspberrypi9.invalid}}}")
    refused = rehearsal.playbook("deploy", f"--inventory={more}", check=False)
    assert "Nobody knows the address of raspberrypi9, so the firewall would keep it out" in refused.output
    assert refused.recap["laser_bot_master"]["failed"] == 1
    knob = json.dumps({"firewall_fleet": ["10.217.0.0/24"]})
    rules = "nft list chain inet laserbot input"
    before = rehearsal.master.run(rules)
    rehearsal.playbook("deploy", f"--inventory={more}", f"--extra-vars={knob}", check=False)
    assert len(re.findall(r"ip saddr (?:\{ )?10\.217\.0\.0/24 .*dport", rehearsal.master.run(rules))) == 5
    updated = rehearsal.playbook("update", f"--inventory={more}")
    assert "raspberrypi9 is off and keeps its image" in updated.output
    assert updated.recap["laser_bot_master"]["failed"] == 0
    rehearsal.playbook("deploy")
    assert rehearsal.master.run(rules) == before


def test_what_somebody_has_closed_is_open_again_and_nothing_else_changes(rehearsal: Rehearsal) -> None:
    """What the hosts were like before the fleet stays noted."""
    master, robot = rehearsal.master, rehearsal.robots[0]
    note = "sha256sum /etc/laserbot/before.json /etc/laserbot/before.tar"
    before = robot.run(note)
    robot.run("chmod 700 /etc/laserbot")
    master.run("chmod 600 /etc/laserbot/tls/front.crt /etc/docker/registry/tls/registry.crt")
    assert changed_tasks(rehearsal.playbook("deploy").output) == [
        "host : Make the fleet's folder",
        "registry : Make the registry's certificate",
        "master : Make or renew the front's certificate",
    ]
    assert robot.run(note) == before


def test_a_dry_run_changes_and_reports_nothing(rehearsal: Rehearsal) -> None:
    run = rehearsal.playbook("deploy", "--check", "--diff")
    assert run.changed == 0, run.output


def test_a_dry_run_with_another_password_of_the_registry_comes_to_its_end(rehearsal: Rehearsal) -> None:
    """Though nobody can log in with it yet."""
    knob = json.dumps({"fleet_registry_password": "another one, long enough"})
    rehearsal.playbook("deploy", "--check", "--diff", f"--extra-vars={knob}")
    assert rehearsal.playbook("deploy").changed == 0


def test_a_deploy_without_an_archive_builds_the_images(rehearsal: Rehearsal, tmp_path: Path) -> None:
    archive = tmp_path / "images.tar"
    knob = f"--extra-vars=fleet_images_archive={archive}"
    dry = rehearsal.playbook("deploy", knob, "--check", check=False)
    assert f"There is no {archive}, and a dry run does not build it" in dry.output
    assert not archive.exists()
    run = rehearsal.playbook("deploy", knob)
    assert changed_tasks(run.output)[0] == "fleet : Build the images if there is no archive"
    with tarfile.open(archive) as file:
        index = file.extractfile("index.json")
        assert index
        digests = {manifest["digest"] for manifest in json.load(index)["manifests"]}
    for machine in rehearsal.machines.values():
        running = {machine.container(service)["Config"]["Image"].partition("@")[2] for service in machine.services}
        assert running <= digests
    rehearsal.playbook("deploy")
    rehearsal.wait_until_complete()


def test_a_changed_knob_changes_the_services_that_read_it_and_no_secret_is_printed(rehearsal: Rehearsal) -> None:
    """First a secret, then, beside it, a rule of the battle."""
    token = "the token of another operator"
    knobs = {
        f'fleet_operator_token="{token}"': (
            [
                "master : Keep the operator's token",
                "release : Run the container laserbot-rosbridge",
                "release : Run the container laserbot-web",
                "release : Run the container laserbot-camera-relay",
            ],
            {"laserbot-rosbridge", "laserbot-web", "laserbot-camera-relay"},
        ),
        "master_hit_damage=39": (["release : Run the container laserbot-web"], {"laserbot-web"}),
    }
    secrets = {token, rehearsal.master.run("cat /etc/laserbot/operator-token"), rehearsal.master.registry_password}
    changed: list[str] = []
    for knob, (tasks, restarted) in knobs.items():
        before = {machine.name: started(machine) for machine in rehearsal.machines.values()}
        changed.append(f"--extra-vars={knob}")
        run = rehearsal.playbook("deploy", *changed, "--diff")
        assert changed_tasks(run.output) == tasks, run.output
        assert not [secret for secret in secrets if not secret or secret in run.output]
        after = {machine.name: started(machine) for machine in rehearsal.machines.values()}
        for name, services in before.items():
            for service, since in services.items():
                assert (after[name][service] == since) == (service not in restarted), service
    assert rehearsal.playbook("deploy").changed == 4
    rehearsal.wait_until_complete()


def test_changed_knobs_restart_only_what_they_concern(rehearsal: Rehearsal) -> None:
    knobs = json.dumps({"firewall_open_ports": [8081], "host_time_servers": ["192.0.2.1"]})
    before = [started(machine) for machine in rehearsal.machines.values()]
    for variables in ([f"--extra-vars={knobs}"], []):
        run = rehearsal.playbook("deploy", *variables)
        assert changed_tasks(run.output) == [
            "host : Write the host's settings",
            "fleet : Run the services with these settings",
            "firewall : Write the rules",
            "fleet : Run the services with these settings",
        ], run.output
        rules = [machine.run("nft list chain inet laserbot input") for machine in rehearsal.machines.values()]
        assert all(("8081" in each) == bool(variables) for each in rules)
    assert [started(machine) for machine in rehearsal.machines.values()] == before


def test_the_master_is_watched_and_has_an_eye_above_as_long_as_its_operator_wants(
    rehearsal: Rehearsal, tmp_path: Path
) -> None:
    """By Debian's Prometheus and Alertmanager, with the operator's word whom to tell, and the tracker of the camera
    above the floor; then nothing is left of them."""
    own = tmp_path / "alertmanager.yml"
    own.write_text((ROOT / "monitoring/alertmanager.yml").read_text().replace("operators", "my_phone"))
    camera = "http://127.0.0.1:9/stream"  # nothing is there: the tracker goes on asking
    watched = {"master_monitoring": True, "master_alertmanager": str(own), "master_overhead_camera": camera}
    knobs = f"--extra-vars={json.dumps(watched)}"
    master = rehearsal.master
    before = packages(master.run), settings(master.run), started(master)
    try:
        assert all(row["failed"] == 0 for row in rehearsal.playbook("deploy", knobs, "--check").recap.values())
        rehearsal.playbook("deploy", knobs)
        assert rehearsal.playbook("deploy", knobs).changed == 0
        checked = rehearsal.playbook("check", knobs, "--limit=laser_bot_master").output
        assert re.search("prometheus sees the masters programs +ok", checked), checked
        assert master.container("laserbot-overhead")["State"]["Running"]
        assert "my_phone" in master.run("amtool config show --alertmanager.url=http://127.0.0.1:9211")
    finally:
        rehearsal.playbook("deploy")
    assert rehearsal.playbook("deploy").changed == 0
    assert (packages(master.run), settings(master.run), started(master)) == before, "as before, and the game went on"
    assert "overhead" not in master.run("docker ps --all")


def test_the_services_stop_and_start(rehearsal: Rehearsal) -> None:
    """In between, a robot whose power fails does not start what was stopped."""
    rehearsal.playbook("stop")
    assert rehearsal.available() == -1
    robot = outside(rehearsal.robots[0])
    power_off(rehearsal.robots[0])
    power_on(rehearsal.robots[0])
    until(lambda: robot.exec_run(["systemctl", "is-active", "docker"]).output == b"active\n", 60, "its engine")
    assert not any(execute(outside(machine), "docker", "ps", "-q") for machine in rehearsal.machines.values())
    rehearsal.playbook("stop", "--extra-vars=state=started")
    rehearsal.wait_until_complete()


def test_an_update_of_a_stopped_fleet_starts_it_as_a_whole(rehearsal: Rehearsal) -> None:
    """Services, and what gives them a second chance: now and after a reboot."""
    rehearsal.playbook("stop")
    rehearsal.playbook("update")
    rehearsal.wait_until_complete()
    for machine in rehearsal.machines.values():
        machine.run("systemctl is-active laserbot-revive")
        machine.run("systemctl is-enabled laserbot-revive")


def test_a_host_that_does_not_reach_the_registry_says_so(rehearsal: Rehearsal) -> None:
    robot = rehearsal.robots[0]
    rehearsal.master.run("systemctl stop docker-registry")
    try:
        run = rehearsal.playbook("deploy", f"--limit={robot.name}", check=False)
    finally:
        rehearsal.master.run("systemctl start docker-registry")
    assert f"{robot.name} does not reach the registry" in run.output
    rehearsal.playbook("deploy")
    assert rehearsal.playbook("deploy").changed == 0, "made up for"


def test_the_operators_token_opens_rosbridge(rehearsal: Rehearsal) -> None:
    """The token reached the service through its file; a wrong one is refused."""
    token = rehearsal.master.run("cat /etc/laserbot/operator-token").strip()
    for mac, allowed in ((token, True), ("wrong", False)):
        assert may_call_any_service(rehearsal, mac) == allowed


@pytest.fixture
def idle(tmp_path: Path) -> Path:
    """A program for the Arduino that does nothing."""
    program = tmp_path / "idle.elf"
    build = ["avr-gcc", "-mmcu=atmega328p", "-x", "c", "-", "-o", str(program)]
    subprocess.run(build, input="int main(void) { for (;;); }", text=True, check=True)
    return program


def test_an_arduino_without_the_firmware_gets_it(rehearsal: Rehearsal, idle: Path) -> None:
    """By the real boot loader. A virtual Arduino has no number that would tell that it is another."""
    robot = rehearsal.robots[0]
    program = "/opt/virtual-arduino/opt/laserbot/firmware/laserbot.elf"
    robot.run(f"cp {program} {program}.kept")
    try:
        copy_into(robot, idle, program)
        robot.run("rm /etc/laserbot/firmware.json")
        robot.run("systemctl restart virtual-arduino")
        until(lambda: rehearsal.available() == len(rehearsal.robots) - 1, 30, "its robot is gone")
        run = rehearsal.playbook("deploy", f"--limit={robot.name}")
    finally:
        robot.run(f"mv {program}.kept {program}")
    assert changed_tasks(run.output) == ["firmware : Write and verify the firmware", "firmware : Note what was flashed"]
    rehearsal.wait_until_complete()
    with Player(rehearsal, "Ann") as ann, Player(rehearsal, "Bob") as bob, Eyes(rehearsal) as eyes:
        assert ann.robot == 1
        start(ann, bob)
        obeys(ann, eyes)


def started(machine: Machine) -> dict[str, str]:
    return {service: machine.container(service)["State"]["StartedAt"] for service in machine.services}


def changed_tasks(output: str) -> list[str]:
    tasks = re.split(r"^(?:TASK|RUNNING HANDLER) \[", output, flags=re.MULTILINE)[1:]
    return [task.partition("]")[0] for task in tasks if re.search("^changed: ", task, re.MULTILINE)]


def may_call_any_service(rehearsal: Rehearsal, mac: str) -> bool:
    with connect(rehearsal.bridge) as bridge:
        bridge.send(json.dumps({"op": "auth", "client": "operator", "mac": mac}))
        bridge.send(json.dumps({"op": "call_service", "service": "/robots_server/get_loggers", "id": "loggers"}))
        answers: list[dict[str, object]] = []

        def answered() -> bool:
            answers.append(json.loads(bridge.recv(timeout=10)))
            return answers[-1]["op"] == "service_response"

        until(answered, 20)
        return bool(answers[-1]["result"])
