"""Both ends of our node under test: rospy, and peers that speak TCPROS by hand."""

import asyncio
import io
import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from std_msgs.msg import String

from tcpros.blocks import Blocks
from tcpros.header import LENGTH, decode, encode
from tcpros.node import Node
from tcpros.specs import TypeSpec
from tests.support.polling import LATEST, Patience, until
from tests.support.programs import ROOT

T = TypeVar("T")

STRING = TypeSpec("std_msgs/String", String._md5sum, String._full_text)


def text(value: str) -> bytes:
    """A serialized std_msgs/String."""
    buffer = io.BytesIO()
    String(value).serialize(buffer)
    return buffer.getvalue()


def value(data: bytes) -> str:
    return str(String().deserialize(data).data)


async def eventually(condition: Callable[[], T], what: str = "", seconds: float = 10.0) -> T:
    """`until` for the event loop."""
    patience = Patience(seconds)
    while not (found := condition()):
        assert not patience.is_over, what or condition
        await asyncio.sleep(0.01)
    return found


async def registered(node: Node, kind: int, name: str, there: bool = True, by: str = "") -> None:
    """Wait until the master knows it, or no longer does. `kind`: 0 publishers, 1 subscribers, 2 services; `by` whom, if
    not by the node itself."""
    async with asyncio.timeout(LATEST):
        while ([name, [by or node.name]] in (await node.master("getSystemState"))[kind]) is not there:
            await asyncio.sleep(0.01)


class RospyPeer:
    """The process of rospy_peer.py."""

    def __init__(self, name: str, environment: Mapping[str, str], *options: str) -> None:
        self.name = f"/{name}"
        self._process = subprocess.Popen(
            [sys.executable, "-m", "tests.integration.tcpros.rospy_peer", name, *options],
            env={**os.environ, **environment}, cwd=ROOT, text=True, bufsize=1,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip
        self.said: list[list[Any]] = []
        self._reader = threading.Thread(target=self._read)
        self._reader.start()
        try:
            until(lambda: self.said, what="the rospy peer")
        except AssertionError:
            self.kill()
            raise

    @property
    def pid(self) -> int:
        return self._process.pid

    def do(self, command: str, *arguments: Any) -> None:
        assert self._process.stdin
        self._process.stdin.write(json.dumps([command, *arguments]) + "\n")

    def advertise(self, topic: str, latch: bool = False) -> None:
        """Until the peer has done so: rospy tells the master first, and latches after that."""
        self.do("advertise", topic, latch)
        until(lambda: ["advertised", topic] in self.said, what=f"{topic} is advertised")

    def subscribe(self, topic: str, as_int8: bool = False) -> None:
        """Until the peer has done so: rospy misses a publisher that appears in the moment of subscribing."""
        self.do("subscribe_as_int8" if as_int8 else "subscribe", topic)
        until(lambda: ["subscribed", topic] in self.said, what=f"{topic} is subscribed")

    def heard(self, topic: str) -> list[Any]:
        return [line[2] for line in self.said if line[:2] == ["heard", topic]]

    def freeze(self, frozen: bool) -> None:
        self._process.send_signal(signal.SIGSTOP if frozen else signal.SIGCONT)

    def kill(self) -> None:
        """As a power cut does."""
        self._process.kill()
        self._end()

    def close(self) -> None:
        assert self._process.stdin
        self._process.stdin.close()
        try:
            self._process.wait(LATEST)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._end()

    def _end(self) -> None:
        self._process.wait()
        self._reader.join()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe
            pipe.close()

    def _read(self) -> None:
        assert self._process.stdout
        for line in self._process.stdout:
            self.said.append(json.loads(line))


class RawPeer:
    """A connection to a node's TCPROS port, by hand."""

    def __init__(self, connected: socket.socket) -> None:
        self._socket = connected
        self._blocks = Blocks()

    @classmethod
    async def connect(cls, node: Node, receive_buffer: int = 0) -> "RawPeer":
        connected = socket.socket()
        connected.setblocking(False)
        if receive_buffer:
            connected.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        await asyncio.get_running_loop().sock_connect(connected, node.tcpros_address)
        return cls(connected)

    @classmethod
    async def subscribe(cls, node: Node, topic: str, receive_buffer: int = 0, **fields: str) -> "RawPeer":
        peer = await cls.connect(node, receive_buffer)
        await peer.say({"callerid": "/raw", "md5sum": "*", "topic": topic, "type": "*", **fields})
        return peer

    async def say(self, header: Mapping[str, str]) -> None:
        await self.send(encode(header))

    async def send(self, data: bytes) -> None:
        await asyncio.get_running_loop().sock_sendall(self._socket, data)

    async def hear_header(self) -> dict[str, str]:
        loop = asyncio.get_running_loop()
        async with asyncio.timeout(LATEST):
            (length,) = LENGTH.unpack(await loop.sock_recv(self._socket, 4))
            block = b""
            while len(block) < length:
                block += await loop.sock_recv(self._socket, length - len(block))
            return decode(block)

    async def hear(self) -> list[bytes]:
        """At least one more message."""
        loop = asyncio.get_running_loop()
        async with asyncio.timeout(LATEST):
            while True:
                data = await loop.sock_recv(self._socket, 2**16)
                assert data, "the node ended the connection"
                if blocks := self._blocks.feed(data):
                    return blocks

    async def hear_until(self, last: bytes) -> list[bytes]:
        heard: list[bytes] = []
        while not heard or heard[-1] != last:
            heard += await self.hear()
        return heard

    async def ended(self) -> bool:
        """Wait for the node to end the connection."""
        loop = asyncio.get_running_loop()
        async with asyncio.timeout(LATEST):
            try:
                while await loop.sock_recv(self._socket, 2**16):
                    pass
            except ConnectionResetError:
                pass
            return True

    def close(self) -> None:
        self._socket.close()
