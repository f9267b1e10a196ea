"""The ROS master, and rospy in a program of ours, against peers that stall or promise more than anybody keeps."""

import ast
import contextlib
import io
import socket
import struct
import xmlrpc.client
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit

import psutil
import pytest
import rosgraph.network

from laser_bot_battle.rospy_cures import MAX_HEADER, MAX_MESSAGE
from tests.integration.tcpros.ends import RospyPeer
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.ros import RosMaster

STALLED = b"POST /RPC2 HTTP/1.1\r\nHost: a\r\nContent-Length: 100\r\n\r\n<"


@pytest.fixture(scope="module")
def guarded(ros_master: RosMaster) -> Iterator[RospyPeer]:
    """A node with rospy as our programs start it."""
    peer = RospyPeer("guarded", ros_master.env, "--guarded")
    yield peer
    peer.close()


def ask(where: tuple[str, int], method: str, *arguments: Any) -> Any:
    """What the ROS master or a node answers."""
    with xmlrpc.client.ServerProxy("http://{}:{}".format(*where)) as proxy:
        answer: Any = getattr(proxy, method)("/test", *arguments)
    return answer[2]


def slave(master: RosMaster, node: str) -> tuple[str, int]:
    url = urlsplit(ask(("127.0.0.1", master.port), "lookupNode", node))
    return str(url.hostname), int(url.port or 0)


def tcpros(master: RosMaster, node: str, topic: str) -> tuple[str, int]:
    _, address, number = ask(slave(master, node), "requestTopic", topic, [["TCPROS"]])
    return str(address), int(number)


def threads_of(pid: int) -> int:
    return psutil.Process(pid).num_threads()


def is_cut(peer: socket.socket) -> bool:
    """Whether the other end has enough before it has got all of 64 MiB."""
    peer.settimeout(20)
    try:
        peer.sendall(bytes(64 * 2**20))
    except ConnectionError:
        return True
    return False


def memory_of(peer: RospyPeer) -> int:
    """In bytes."""
    return int(psutil.Process(peer.pid).memory_info().rss)


@pytest.mark.slow
@pytest.mark.parametrize("program", ["the ROS master", "a node"])
def test_stalled_calls_hold_no_thread_and_nobody_up(program: str, ros_master: RosMaster, guarded: RospyPeer) -> None:
    pid, where = guarded.pid, slave(ros_master, "/guarded")
    if program == "the ROS master":
        pid, where = ros_master.pid, ("127.0.0.1", ros_master.port)
    before = threads_of(pid)
    with contextlib.ExitStack() as stack:
        stalled = [stack.enter_context(socket.create_connection(where)) for _ in range(200)]
        for peer in stalled:
            peer.sendall(STALLED)
        assert ask(where, "getPid") == pid
        until(lambda: threads_of(pid) <= before + 2, 15, "the threads are free again")


@pytest.mark.slow
def test_a_crowd_has_a_limit(ros_master: RosMaster) -> None:
    before = threads_of(ros_master.pid)
    with contextlib.ExitStack() as stack:
        for _ in range(400):
            stack.enter_context(socket.create_connection(("127.0.0.1", ros_master.port))).sendall(STALLED)
        assert threads_of(ros_master.pid) <= before + 310
        until(lambda: threads_of(ros_master.pid) <= before + 2, 15, "the threads are free again")


@pytest.mark.parametrize("length", ["4294967296", "-1", "5_000", ""])
def test_a_call_of_an_impossible_length_is_refused_unread(ros_master: RosMaster, length: str) -> None:
    with socket.create_connection(("127.0.0.1", ros_master.port)) as peer:
        peer.sendall(f"POST /RPC2 HTTP/1.1\r\nContent-Length: {length}\r\n\r\n".encode())
        peer.settimeout(20)
        assert b" 413 " in peer.recv(100)
        assert is_cut(peer)


def test_a_declared_header_of_4_gib_is_not_kept(ros_master: RosMaster, guarded: RospyPeer) -> None:
    before = memory_of(guarded)
    with socket.create_connection(tcpros(ros_master, "/guarded", "/rosout")) as peer:
        peer.sendall(struct.pack("<I", 2**32 - 1))
        assert is_cut(peer)
    assert memory_of(guarded) < before + MAX_HEADER


def test_a_declared_request_of_4_gib_is_not_kept(ros_master: RosMaster, guarded: RospyPeer) -> None:
    before = memory_of(guarded)
    with socket.create_connection(tcpros(ros_master, "/guarded", "/rosout")) as peer:
        header = {"service": "/guarded/get_loggers", "callerid": "/test", "md5sum": "*"}
        rosgraph.network.write_ros_handshake_header(peer, header)
        assert "md5sum" in rosgraph.network.read_ros_handshake_header(peer, io.BytesIO(), 4096)
        peer.sendall(struct.pack("<I", 2**32 - 1))
        assert is_cut(peer)
    assert memory_of(guarded) < before + 4 * MAX_MESSAGE


def test_whoever_uses_rospy_guards_it() -> None:
    for path in (path for room in ("server", "robot", "sim") for path in (ROOT / room).rglob("*.py")):
        calls = [
            node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            for node in ast.walk(ast.parse(path.read_text()))
            if isinstance(node, ast.Call)
        ]
        assert "init_node" not in calls or "cure_rospy" in calls, path
