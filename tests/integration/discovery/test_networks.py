"""A robot and its master in the networks that people have: each joins by the address at which it can be reached."""

import sys
from pathlib import Path

import pytest

from tests.integration.discovery.master import LanMaster
from tests.integration.discovery.robot import LanRobot
from tests.support import networks
from tests.support.lan import Lan, Machine, needs_root
from tests.support.polling import until

pytestmark = needs_root

# as any ROS node does it: ask the master for a node, and the node for a topic; then connect
SUBSCRIBE = """
import socket, sys
from xmlrpc.client import ServerProxy
node = ServerProxy(f"http://{sys.argv[1]}:11311").lookupNode("/test", "/robots_server")[2]
topic, protocol = "/game_status", ["TCPROS"]
_, host, port = ServerProxy(node).requestTopic("/test", topic, [protocol])[2]
assert node.startswith(f"http://{host}:"), (node, host)
socket.create_connection((host, port), 5).close()
print(host, end="")
"""


def test_robots_of_the_lan_join_although_a_vpn_is_the_default_route(lan: Lan, tmp_path: Path) -> None:
    on_master, on_robot = lan.machine(), lan.machine()
    networks.vpn(on_master)
    networks.containers(on_master)
    networks.vpn(on_robot, "10.8.0.3")
    with LanMaster(on_master, "hall", tmp_path) as master, LanRobot(on_robot, tmp_path) as robot:
        robot.wait_for("arena 'hall' at 10.9.0.1, announced")
        master.has_robot()
        assert "10.9.0.1:" in master.node("/robots_server")
        master.announcer.wait_for("arena 'hall' is announced at 10.9.0.1\n")
        assert "10.8.0.2 on tun0, leads to one peer, as a VPN or a modem does" in master.announcer.output


def test_robots_of_two_networks_join_each_by_the_address_by_which_it_came(lan: Lan, tmp_path: Path) -> None:
    on_master, near = lan.machine(), lan.machine()
    far = networks.second_network(lan, on_master)
    with (
        LanMaster(on_master, "hall", tmp_path) as master,
        LanRobot(near, tmp_path) as first,
        LanRobot(far, tmp_path, LASERBOT_ROBOT_NAME="far-robot") as second,
    ):
        first.wait_for("arena 'hall' at 10.9.0.1, announced")
        second.wait_for("arena 'hall' at 192.168.4.1, announced")
        until(lambda: master.robots() == 2, 30, "both robots")
        assert heard_from(near, "10.9.0.1") == "10.9.0.1"
        assert heard_from(far, "192.168.4.1") == "192.168.4.1"


def heard_from(machine: Machine, master: str) -> str:
    """The address at which that machine gets the game's status, once it has got it."""
    return machine.run(sys.executable, "-c", SUBSCRIBE, master)


def test_players_come_by_ipv6_alone_and_robots_by_ipv4(lan: Lan, tmp_path: Path) -> None:
    on_master, on_robot, player = lan.machine(), lan.machine(), lan.machine()
    player.ip("addr", "flush", "dev", "eth0", "scope", "global")
    for number, machine in ((1, on_master), (3, player)):
        machine.ip("addr", "add", f"fd00::{number}/64", "dev", "eth0", "nodad")
    with LanMaster(on_master, "hall", tmp_path) as master, LanRobot(on_robot, tmp_path):
        master.has_robot()
        assert "10.9.0.1:" in master.node("/robots_server")
        assert "<title>" in player.run("curl", "-sf", "--max-time", "10", "http://[fd00::1]:5000/")


@pytest.mark.slow
def test_another_address_by_dhcp_is_the_lans_again_and_never_the_vpns(lan: Lan, tmp_path: Path) -> None:
    on_master, on_robot = lan.machine(), lan.machine()
    networks.vpn(on_master)
    with LanMaster(on_master, "hall", tmp_path) as master, LanRobot(on_robot, tmp_path):
        master.has_robot()
        on_master.ip("addr", "flush", "dev", "eth0", "scope", "global")
        on_master.ip("addr", "add", "10.9.0.7/24", "dev", "eth0")
        until(lambda: "10.9.0.7:" in master.node("/robots_server"), 30, "the game at the new address")
        master.announcer.wait_for("arena 'hall' is announced at 10.9.0.7\n")
        master.has_robot()
        assert "is announced at 10.8.0.2" not in master.announcer.output
