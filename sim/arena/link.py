"""The TCP server to which the robots' hardware connects (lines: see protocol.py)."""

import asyncio
import contextlib
import logging
import random
import socket
from collections.abc import Iterable
from typing import NoReturn

from laser_bot_battle.listening import addresses
from laser_bot_battle.openings import OPEN_TIMEOUT, Openings
from sim.arena import ambient, protocol
from sim.arena.ambient import Ambient
from sim.arena.protocol import LinkError
from sim.arena.world import MAX_ROBOTS, ArenaError, Robot, World

MAX_STRANGERS = 24  # connections that are no robot's yet
MAX_CONNECTIONS = MAX_STRANGERS + MAX_ROBOTS
FAREWELL_SECONDS = 1.0  # for the peer to read why it is disconnected
MAX_UNSENT = 4096  # bytes; a robot that reads so slowly is stuck
# what the kernel may hold for a robot; more would only make its light older
SEND_BUFFER = 64 * 2**10  # bytes
TURN = 0.002  # s of what one robot tells before the others get their turn
LIGHT_DELAY = 0.004  # s; several robots' motions within this time are looked at together

_log = logging.getLogger(__name__)


class Peer:
    """One robot's hardware, or a stranger before its hello."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader = reader
        self.writer = writer
        self.source = 0  # number of its light among the robots'
        self._is_refused = False
        self.address = "{}:{}".format(*writer.get_extra_info("peername")[:2])

    async def line(self) -> bytes | None:
        """The next line without its end, None at the end of the connection; LinkError if it is too long."""
        try:
            line = await self.reader.readline()
        except ValueError:
            raise LinkError(f"line longer than {protocol.MAX_LINE} bytes") from None
        return line.rstrip(b"\r\n") if line.endswith(b"\n") else None

    def send(self, line: bytes) -> None:
        """Send at once; a peer that does not read is cut off."""
        if self.writer.is_closing():
            return
        if self.writer.transport.get_write_buffer_size() > MAX_UNSENT:
            _log.warning("%s does not read what we send: disconnected", self.address)
            self.writer.transport.abort()
            return
        self.writer.write(line)

    def cut(self) -> None:
        """Others need its place."""
        _log.warning("%s disconnected: too many connections", self.address)
        if self._is_refused:
            self.writer.transport.abort()
        else:
            self.send(protocol.error("too many connections"))
            self.writer.close()

    async def refuse(self, text: str) -> None:
        """Say why and close. What the peer still sends is read, or the kernel would reset the connection unread."""
        self.send(protocol.error(text))
        self._is_refused = True
        with contextlib.suppress(OSError, TimeoutError):
            self.writer.write_eof()
            async with asyncio.timeout(FAREWELL_SECONDS):
                while await self.reader.read(4096):
                    pass


class Link:
    """Connects robots' hardware with the world: their wheels and lights go in, what they see comes out at once."""

    def __init__(self, world: World, light: Ambient) -> None:
        """`light` is there beside the robots'."""
        self._world = world
        self._ambient = light
        self._remote: asyncio.Task[NoReturn] | None = None
        self._robots: dict[str, Peer] = {}
        self._open: set[Peer] = set()
        # robots of one machine share its address
        self._strangers = Openings(MAX_STRANGERS, MAX_STRANGERS + 1)
        self._light_due: asyncio.TimerHandle | None = None
        self._server: asyncio.Server | None = None

    async def start(self, bind: str, port: int) -> None:
        """Listen; OSError if that is impossible."""
        self._server = await asyncio.start_server(self._serve, addresses(bind), port, limit=protocol.MAX_LINE)
        if self._ambient.remote:
            self._remote = asyncio.create_task(self._press_keys())

    async def stop(self) -> None:
        """Close the listening socket and every connection."""
        if self._remote:
            self._remote.cancel()
        if self._server:
            self._server.close()
        for peer in list(self._open):
            peer.writer.transport.abort()
        if self._server:
            await self._server.wait_closed()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        peer = Peer(reader, writer)
        _configure(writer.get_extra_info("socket"))
        self._open.add(peer)
        self._strangers.add(peer, asyncio.get_running_loop().time())
        try:
            await self._welcome(peer)
        except (LinkError, ArenaError) as reason:
            _log.warning("%s disconnected: %s", peer.address, reason)
            self._strangers.add(peer, asyncio.get_running_loop().time())  # again, if it was a robot
            await peer.refuse(str(reason))
        except OSError:
            pass  # the peer is gone, as _welcome has logged
        finally:
            self._strangers.remove(peer)
            self._open.discard(peer)
            writer.close()

    async def _welcome(self, peer: Peer) -> None:
        try:
            async with asyncio.timeout(OPEN_TIMEOUT):
                hello = await peer.line()
        except TimeoutError:
            raise LinkError("no hello") from None
        if hello is None:
            return
        name = protocol.parse_hello(hello)
        if older := self._robots.get(name):
            older.send(protocol.error("a newer connection has this robot's name"))
            older.writer.close()
            self._drop(name)
        robot = self._world.arrive(name)
        self._strangers.remove(peer)
        peer.source = min(set(range(MAX_ROBOTS)) - {other.source for other in self._robots.values()})
        self._robots[name] = peer
        _log.info("%s on the floor (%s)", name, peer.address)
        try:
            self._tell(self._world.update_light())
            if not robot.lit:
                peer.send(protocol.light(self._ambient.sun))
            if self._ambient.lamp:
                peer.send(protocol.lamp())
            await self._listen(name, peer)
        finally:
            if self._robots.get(name) is peer:
                self._drop(name)
                _log.info("%s is gone", name)

    async def _listen(self, name: str, peer: Peer) -> None:
        """Follow what a robot's hardware does until its connection ends or another has its name."""
        loop = asyncio.get_running_loop()
        began = loop.time()
        while (line := await peer.line()) is not None and self._robots.get(name) is peer:
            match protocol.parse_event(line):
                case protocol.Wheels(left, right):
                    self._world.turn_wheels(name, left, right)
                    self._look_soon()
                case protocol.Beam(on):
                    self._world.set_beam(name, on)
                    self._tell(self._world.update_light())
                case protocol.CarrierEdge(on, cycle):
                    for robot, seen in self._world.set_carrier(name, on, cycle, loop.time()):
                        self._robots[robot.name].send(protocol.carrier(peer.source, seen, cycle))
            if loop.time() - began > TURN:  # a line that is there already is read without waiting for anything
                await asyncio.sleep(0)
                began = loop.time()

    def _drop(self, name: str) -> None:
        del self._robots[name]
        self._world.leave(name)
        self._tell(self._world.update_light())

    def _look_soon(self) -> None:
        """Motion changes the light too: look once for all motions of the next moment."""
        if self._light_due is None and self._world.any_light:
            self._light_due = asyncio.get_running_loop().call_later(LIGHT_DELAY, self._look)

    def _look(self) -> None:
        self._light_due = None
        self._tell(self._world.update_light())

    def _tell(self, changed: Iterable[Robot]) -> None:
        for robot in changed:
            self._robots[robot.name].send(protocol.light(robot.lit or self._ambient.sun))

    async def _press_keys(self) -> NoReturn:
        """The remote control. Each part of a press is sent as a whole: its edges have their times."""
        loop, chance = asyncio.get_running_loop(), random.Random(0)
        while True:
            start = loop.time()
            for part in ambient.key_press(chance.randrange(256), chance.randrange(256)):
                began = int(loop.time() * 1_000_000) * ambient.US
                lines = b"".join(protocol.carrier(ambient.SOURCE, on, began + cycle) for cycle, on in part)
                for peer in self._robots.values():
                    peer.send(lines)
                await asyncio.sleep(ambient.REPEAT_PERIOD)
            await asyncio.sleep(start + ambient.PRESS_PERIOD - loop.time())


def _configure(peer: socket.socket) -> None:
    """Answers to light are small and urgent; a host that lost its power is noticed within about 10 s."""
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 4)
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 2)
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 3)
