"""Playbooks on a fleet that is deployed: what is as it should be stays untouched, what is not is mended."""

import json
import re

from websockets.sync.client import connect

from tests.support.fleet import Machine
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal


def test_the_operators_checks_pass(rehearsal: Rehearsal) -> None:
    """All of tests/fleet/checks, on every host, as a table."""
    run = rehearsal.playbook("check")
    rows = [line for line in run.output.splitlines() if " ok " in line]
    assert len(rows) > 15, run.output
    assert not any("FAILED" in row for row in rows)


def test_a_host_that_would_be_locked_out_is_left_alone(rehearsal: Rehearsal) -> None:
    """The firewall would close SSH for the machine that deploys."""
    variables = json.dumps({"fleet_control_networks": ["192.0.2.0/24"]})
    run = rehearsal.playbook("deploy", f"--extra-vars={variables}", "--limit=raspberrypi1", check=False)
    assert "lock itself out" in run.output
    assert run.recap["raspberrypi1"]["failed"] == 1
    assert rehearsal.robots[0].run("true") == ""


def test_a_second_deploy_changes_nothing(rehearsal: Rehearsal) -> None:
    run = rehearsal.playbook("deploy")
    print(f"second run: {run.seconds:.0f} s")
    assert run.changed == 0, run.output
    assert set(run.recap) == set(rehearsal.machines)


def test_a_dry_run_changes_and_reports_nothing(rehearsal: Rehearsal) -> None:
    run = rehearsal.playbook("deploy", "--check", "--diff")
    assert run.changed == 0, run.output


def test_one_changed_knob_changes_one_service_and_no_secret_is_printed(rehearsal: Rehearsal) -> None:
    before = {machine.name: started(machine) for machine in rehearsal.machines.values()}
    run = rehearsal.playbook("deploy", "--extra-vars=master_hit_damage=39", "--diff")
    assert run.changed == 1, run.output
    assert changed_tasks(run.output) == ["docker : Run the container laserbot-web"]
    token = rehearsal.master.run("cat /etc/laserbot/operator-token").strip()
    assert token
    assert token not in run.output
    after = {machine.name: started(machine) for machine in rehearsal.machines.values()}
    for name, services in before.items():
        for service, start in services.items():
            assert (after[name][service] == start) == (service != "laserbot-web"), service
    assert rehearsal.playbook("deploy").changed == 1
    rehearsal.wait_until_complete()


def test_the_services_stop_and_start(rehearsal: Rehearsal) -> None:
    rehearsal.playbook("stop")
    assert rehearsal.available() == -1
    assert all(not machine.run("docker ps -q") for machine in rehearsal.machines.values())
    rehearsal.playbook("stop", "--extra-vars=state=started")
    rehearsal.wait_until_complete()


def test_the_operators_token_opens_rosbridge(rehearsal: Rehearsal) -> None:
    """The token reached the service through its file; a wrong one is refused."""
    token = rehearsal.master.run("cat /etc/laserbot/operator-token").strip()
    for mac, allowed in ((token, True), ("wrong", False)):
        assert may_call_any_service(rehearsal, mac) == allowed


def started(machine: Machine) -> dict[str, str]:
    return {service: machine.container(service)["State"]["StartedAt"] for service in machine.services}


def changed_tasks(output: str) -> list[str]:
    tasks = re.split(r"^TASK \[", output, flags=re.MULTILINE)[1:]
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
