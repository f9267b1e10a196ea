"""What a player's laptop, in the same LAN as the fleet, can reach: the game, and nothing else."""

import asyncio
import json
import shlex
import ssl
from pathlib import Path

import pytest
import requests
from websockets.asyncio.client import connect

from fleet import Machine
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal, ask_from

OPEN = {"master": {80, 443, 5000, 9090, 9091}, "robots": set()}
# what listens on the hosts or might: SSH, time, ROS master, engine, registry, arbitrary ports of ROS nodes
PORTS = [22, 80, 111, 123, 443, 2375, 2376, 5000, 5353, 5443, 8090, 9090, 9091, 11311, 32768, 40000, 50000, 60999]

SCAN = """
import json, socket
from concurrent.futures import ThreadPoolExecutor
def reached(target):
    with socket.socket() as s:
        s.settimeout(2)
        return s.connect_ex(tuple(target)) == 0
targets = json.loads({targets!r})
with ThreadPoolExecutor(200) as pool:
    print(json.dumps([t for t, yes in zip(targets, pool.map(reached, targets)) if yes]))
"""


def listening(machine: Machine) -> list[int]:
    lines = machine.run("ss -Htln").splitlines()
    return sorted({int(line.split()[3].rpartition(":")[2]) for line in lines if "127.0.0." not in line.split()[3]})


def test_a_player_reaches_the_game_and_nothing_else(rehearsal: Rehearsal) -> None:
    targets = []
    for machine in rehearsal.machines.values():
        ports = listening(machine)
        assert 22 in ports
        targets += [(machine.address, port) for port in sorted({*PORTS, *ports})]
    assert any(port > 32768 for _, port in targets), "ROS nodes listen"
    found = json.loads(ask_from("laserbot-fleet", SCAN.format(targets=json.dumps(targets))))
    wanted = [
        [machine.address, port] for machine in rehearsal.machines.values() for port in sorted(OPEN[machine.group])
    ]
    assert sorted(found) == sorted(wanted)


ASK_FOR_THE_TIME = """
import socket
with socket.socket(type=socket.SOCK_DGRAM) as s:
    s.settimeout(2)
    s.sendto(bytes([0x23]) + bytes(47), ({address!r}, 123))
    try:
        print(len(s.recv(100)))
    except TimeoutError:
        print("silence")
"""


def test_a_player_is_not_told_the_time_as_robots_are(rehearsal: Rehearsal) -> None:
    """The firewall knows UDP, too."""
    ask = ASK_FOR_THE_TIME.format(address=rehearsal.master.address)
    assert ask_from("laserbot-fleet", ask).strip() == "silence"
    assert rehearsal.robots[0].run(f"python3 -c {shlex.quote(ask)}").strip() == "48"


def test_the_robots_reach_the_ros_master_and_the_registry(rehearsal: Rehearsal) -> None:
    """The counterpart of the test above: those ports are closed to players, not to all."""
    for robot in rehearsal.robots:
        for port in (5000, 5443, 11311):
            connect = f"import socket;socket.create_connection(('laser_bot_master.local',{port}),5)"
            robot.run(f'python3 -c "{connect}"')


CALL = """
import socket
calls = []
for _ in range({limit} + 50):
    calls.append(socket.socket())
    if calls[-1].connect_ex(({address!r}, {port})):
        break
print(len(calls), flush=True)
"""
CALL_ONCE = "import socket; socket.create_connection(({address!r}, {port}), 5)"


@pytest.mark.parametrize(("port", "limit"), [(11311, 100), (80, 400)])
def test_a_host_that_calls_the_master_without_end_leaves_room_for_others(
    rehearsal: Rehearsal, port: int, limit: int
) -> None:
    mad, other = rehearsal.robots[:2]
    calls = CALL.format(address=rehearsal.master.address, port=port, limit=limit)
    held = f"timeout 120 python3 -c {shlex.quote(calls + 'import signal; signal.pause()')} >/tmp/calls 2>&1 & echo $!"
    process = mad.run(held).strip()
    try:
        until(lambda: mad.run("cat /tmp/calls").strip(), 20, "it has called")
        assert limit / 2 < int(mad.run("cat /tmp/calls")) <= limit + 1
        other.run(f"python3 -c {shlex.quote(CALL_ONCE.format(address=rehearsal.master.address, port=port))}")
    finally:
        mad.run(f"kill {process}; rm /tmp/calls")


def test_the_master_reaches_a_robots_nodes_and_other_robots_do_not(rehearsal: Rehearsal) -> None:
    first, second = rehearsal.robots[:2]
    nodes = [port for port in listening(second) if port >= 32768]
    assert nodes
    for port in nodes:
        connect = f"import socket;socket.create_connection(('{second.address}',{port}),3)"
        rehearsal.master.run(f'python3 -c "{connect}"')
        assert "TimeoutError" in first.host.run(f'python3 -c "{connect}"').stderr


def test_a_robot_cannot_log_in_to_the_master(rehearsal: Rehearsal) -> None:
    connect = f"import socket;socket.create_connection(('{rehearsal.master.address}',22),3)"
    answer = rehearsal.robots[0].host.run(f'python3 -c "{connect}"')
    assert "TimeoutError" in answer.stderr


def test_players_come_by_tls_with_a_certificate_of_the_fleets_own(rehearsal: Rehearsal, tmp_path: Path) -> None:
    """They get the authority's certificate without TLS."""
    authority = tmp_path / "ca.crt"
    authority.write_bytes(requests.get(f"http://{rehearsal.master.address}/ca.crt", timeout=5).content)
    home = requests.get(f"http://{rehearsal.master.address}/", timeout=5, verify=str(authority))
    assert home.url == f"https://{rehearsal.master.address}/"
    assert "LaserBot Battle" in home.text

    async def first_status() -> str:
        # websockets' client in threads reads and writes a TLS connection at once, and one request in a hundred is lost
        trusted = ssl.create_default_context(cafile=authority)
        async with connect(f"wss://{rehearsal.master.address}/rosbridge", ssl=trusted) as rosbridge:
            await rosbridge.send('{"op": "subscribe", "topic": "/game_status"}')
            return str(await asyncio.wait_for(rosbridge.recv(), 5))

    assert "users" in asyncio.run(first_status())
