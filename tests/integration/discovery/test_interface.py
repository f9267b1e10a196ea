"""LASERBOT_INTERFACE: one setting says which network it is."""

import pytest

from tests.support import networks
from tests.support.lan import Lan, needs_root

pytestmark = needs_root
THERE = "192.168.4.1 on wlan0, 10.8.0.2 on tun0"
PROGRAMS = (
    "server.main",
    "server.rosbridge",
    "server.camera",
    "server.announcer",
    "robot.id_service_client",
    "robot.camera",
    "robot.find",
    "server.bots",
)


def test_one_that_is_not_there_ends_each_program_and_names_those_that_are(lan: Lan) -> None:
    machine = lan.machine()
    networks.second_network(lan, machine)
    networks.vpn(machine)
    env = {"LASERBOT_INTERFACE": "wlan7", "LASERBOT_MASTER": "", "LASERBOT_CAMERA": "/dev/video0"}
    started = [machine.python(module, env=env) for module in PROGRAMS]
    for program in started:
        assert program.exit_code(60) == 2, program.output
        assert "LASERBOT_INTERFACE=wlan7: there is no interface, address or network 'wlan7' on this machine; " in (
            program.output
        )
        assert f"there is 10.9.0.1 on eth0, {THERE}" in program.output
        assert "Traceback" not in program.output


@pytest.mark.parametrize("chosen", ["wlan0", "192.168.4.1", "192.168.4.0/24"])
def test_it_is_announced_there_and_nowhere_else(lan: Lan, chosen: str) -> None:
    machine = lan.machine()
    networks.second_network(lan, machine)
    program = machine.python("server.announcer", env={"LASERBOT_INTERFACE": chosen, "LASERBOT_ARENA": "hall"})
    try:
        program.wait_for("arena 'hall' is announced at 192.168.4.1\n")
        assert "networks: 192.168.4.1 on wlan0 (chosen); left out: 10.9.0.1 on eth0, not chosen" in program.output
    finally:
        program.kill()
