"""A robot and its master in the networks that people have: each joins by the address at which it can be reached."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from laser_bot_battle.names import MASTER_HOST_ALIAS
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

# a node that publishes on this machine, long after the robots came; who asks it for a topic, comes by which address?
PUBLISH_LATE = """
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer
class Handler(SimpleXMLRPCRequestHandler):
    def do_POST(self):
        print("asked at", self.connection.getsockname()[0], flush=True)
        super().do_POST()
server = SimpleXMLRPCServer(("0.0.0.0", 0), Handler, logRequests=False)
server.register_function(lambda *_: (0, "not now", []), "requestTopic")
uri = f"http://10.9.0.1:{server.server_address[1]}/"
for robot in (0, 1):
    topic = f"/Robot{robot}/command"
    ServerProxy("http://127.0.0.1:11311").registerPublisher("/late", topic, "laser_bot_battle/Robot_msg", uri)
server.serve_forever()
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
        for robot in (first, second):
            robot.wait_for("/command")
        master.announcer.wait_for(f"{MASTER_HOST_ALIAS} is this machine")
        assert addresses_of(MASTER_HOST_ALIAS, far) == ["192.168.4.1"]
        assert addresses_of(MASTER_HOST_ALIAS, near) == ["10.9.0.1"]
        late = on_master.program(sys.executable, "-c", PUBLISH_LATE)
        try:
            late.wait_for("asked at 10.9.0.1\n")
            late.wait_for("asked at 192.168.4.1\n")
        finally:
            late.kill()


def addresses_of(name: str, asker: Machine) -> list[str]:
    """What that machine hears about a host name."""
    program = asker.python("tests.integration.discovery.ears", name)
    assert program.exit_code() == 0, program.output
    found: list[str] = json.loads(program.output)
    return found


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
def test_a_4g_stick_beside_the_wifi_keeps_no_robot_away(lan: Lan, tmp_path: Path) -> None:
    on_master, on_robot = lan.machine(), lan.machine()
    networks.stick(on_master)
    with LanMaster(on_master, "hall", tmp_path) as master, LanRobot(on_robot, tmp_path) as robot:
        robot.wait_for("arena 'hall' at 10.9.0.1, announced")
        master.has_robot()
        assert heard_from(on_robot, "10.9.0.1") == "10.9.0.1"


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


@pytest.mark.slow
def test_a_battle_goes_on_when_dhcp_gives_the_master_another_address(lan: Lan, tmp_path: Path) -> None:
    on_master, one, other = lan.machine(), lan.machine(), lan.machine()
    robots = LanRobot(one, tmp_path), LanRobot(other, tmp_path, LASERBOT_ROBOT_NAME="other-robot")
    with LanMaster(on_master, "hall", tmp_path) as master, robots[0], robots[1]:
        until(lambda: master.robots() == 2, 60, "both robots")
        players = {name: tmp_path / name for name in ("Ann", "Bob")}
        for name, cookies in players.items():
            assert '"OK"' in post(on_master, cookies, "signUpUser", f"data={name}")
        for name, cookies in players.items():
            assert '"OK"' in post(on_master, cookies, "playerReady", f"user={name}&ready=1")

        def fights() -> bool:
            """Both pages ask, as they do all the time."""
            told = [json.loads(post(on_master, page, "updateGameStatus", "") or "{}") for page in players.values()]
            return all(one.get("game") == 2 and len(json.loads(one["users"])) == 2 for one in told)

        until(fights, 40, "the battle")
        on_master.ip("addr", "flush", "dev", "eth0", "scope", "global")
        on_master.ip("addr", "add", "10.9.0.7/24", "dev", "eth0")

        def drive_again() -> bool:
            fights()
            return all(robot.output.count("/command (laser_bot_battle/Robot_msg) joined") == 2 for robot in robots)

        until(drive_again, 60, "both robots at the new address")
        assert "10.9.0.7:" in master.node("/robots_server")
        assert fights()
        assert master.server.output.count("battle 1 started") == 1
        assert "battle 1 over" not in master.server.output


def post(machine: Machine, cookies: Path, route: str, fields: str) -> str:
    """What the web server on that machine answers; "" while it is away."""
    words = ("-s", "--max-time", "5", "-b", str(cookies), "-c", str(cookies), "-d", fields)
    ask = machine.command("curl", *words, f"http://127.0.0.1:5000/{route}")
    return subprocess.run(ask, capture_output=True, text=True, check=False, timeout=30).stdout
