"""Engines, containers, disks."""

from collections.abc import Callable

import pytest

from fleet import SERVICES
from tests.support.play import PLAYING, obeys, start
from tests.support.player import Eyes, Player
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal

pytestmark = pytest.mark.slow

Measured = Callable[[str], None]


def test_the_engines_restart_in_a_battle(
    rehearsal: Rehearsal, players: tuple[Player, Player], measured: Measured
) -> None:
    """Live restore: nobody notices."""
    ann, bob = players
    with Eyes(rehearsal) as eyes:
        start(ann, bob)
        number = ann.look()["battle"]
        measured("")
        for machine in rehearsal.machines.values():
            machine.run("systemctl restart docker")
        measured("all engines have restarted")
        obeys(ann, eyes)
        assert (ann.look()["game"], ann.look()["battle"]) == (PLAYING, number)
        assert {user["name"] for user in ann.look()["users"]} == {"Ann", "Bob"}


@pytest.mark.parametrize("service", [*SERVICES["master"], *SERVICES["robots"]])
def test_a_container_is_killed(rehearsal: Rehearsal, measured: Measured, service: str) -> None:
    machine = rehearsal.robots[0] if service == "laserbot-robot" else rehearsal.master
    before = machine.container(service)["RestartCount"]
    # as a crash, not as `docker kill`, after which the engine leaves a container alone
    machine.run(f"kill -9 $(docker inspect --format '{{{{.State.Pid}}}}' {service})")
    measured("")
    until(lambda: machine.container(service)["RestartCount"] > before, 30, "started again")
    until(lambda: machine.container(service)["State"]["Health"]["Status"] == "healthy", 90, "healthy")
    measured("healthy")
    rehearsal.wait_until_complete(60)
    measured("all robots are there")
