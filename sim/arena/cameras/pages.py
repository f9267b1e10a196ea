"""Pictures by HTTP, as ustreamer has those of a camera: /eyes/<robot>/stream and /eyes/<robot>/snapshot of what robots
see, /overhead/stream and /overhead/snapshot of the floor from above.
"""

import asyncio
import contextlib
import logging
import re
import socket
from collections.abc import AsyncIterator, Iterator
from functools import partial

from aiohttp import web

from laser_bot_battle.names import RATE_HEADER, RELAY_HEADER
from sim.arena.ambient import Ambient
from sim.arena.cameras.scene import Room, Scene
from sim.arena.cameras.streams import Eye, Picture, Streams, scene_of
from sim.arena.overhead.conditions import Conditions
from sim.arena.overhead.room import Room as OverheadRoom
from sim.arena.world import World

MAX_CONNECTIONS = 32  # the relay has one for each robot
MAX_UNSENT = 16_384  # bytes on the way to one reader; more would be old pictures
SEND_SECONDS = 5.0  # for one picture; a reader that takes longer is gone
SNAPSHOT_SECONDS = 20.0  # until there is a picture; the first one takes longest
BOUNDARY = "boundarydonotcross"  # ustreamer's
HEADERS = {"Cache-Control": "no-store"}
RATE = 20  # pictures a second of each robot
CAMERAS = "/eyes/"  # before a robot's name
OVERHEAD_RATE = 15
OVERHEAD_UNSENT = 262_144  # bytes; its pictures are larger, and come late through less
OVERHEAD = "/overhead"

_RATE = re.compile(r"[1-9][0-9]{0,2}")
_log = logging.getLogger(__name__)


class CameraPages:
    """The paths below /eyes and /overhead."""

    def __init__(self, world: World, ambient: Ambient, timecode: bool, conditions: Conditions) -> None:
        self._world = world
        floor = world.floor
        room = Room(floor.width, floor.height, floor.walls, ambient, timecode)
        self._eyes = Streams("sim.arena.cameras", room.encode(), RATE, self._seen_by)
        above = OverheadRoom(floor, conditions)
        self._overhead = Streams("sim.arena.overhead", above.encode(), OVERHEAD_RATE, partial(scene_of, world))

    def add_to(self, app: web.Application) -> None:
        app.router.add_get(CAMERAS + "{robot}/stream", self._stream)
        app.router.add_get(CAMERAS + "{robot}/snapshot", self._snapshot)
        app.router.add_get(OVERHEAD + "/stream", self._stream)
        app.router.add_get(OVERHEAD + "/snapshot", self._snapshot)
        app.cleanup_ctx.append(self._run_streams)
        app.on_shutdown.append(self._say_goodbye)  # type: ignore[arg-type]  # typed for an older aiosignal

    async def _run_streams(self, _app: web.Application) -> AsyncIterator[None]:
        painting = [asyncio.create_task(streams.paint_for_ever()) for streams in (self._eyes, self._overhead)]
        yield
        for task in painting:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task

    async def _say_goodbye(self, _app: web.Application) -> None:
        self._eyes.close()
        self._overhead.close()

    def _seen_by(self, robot: str, now: float, taken: float) -> Scene | None:
        return scene_of(self._world, robot, now, taken) if robot in self._world.robots else None

    async def _stream(self, request: web.Request) -> web.StreamResponse:
        streams, name = self._admitted(request)
        rate = _wanted_rate(request, streams.rate)
        kind = f"multipart/x-mixed-replace;boundary={BOUNDARY}"
        stream = web.StreamResponse(headers={**HEADERS, "Content-Type": kind})
        stream.force_close()  # nothing can follow a stream
        if request.method == "HEAD":
            return stream
        with _looking(streams, name, rate) as eye:
            await stream.prepare(request)
            _keep_little(request, OVERHEAD_UNSENT if streams is self._overhead else MAX_UNSENT)
            try:
                await self._send(request, stream, f"--{BOUNDARY}\r\n".encode())
                picture = None
                while (picture := await eye.after(picture)) is not None:
                    await self._send(request, stream, part_of(picture, streams.rate))
            except TimeoutError:
                _log.warning("one who looks through the eyes of %s has stopped reading: disconnected", name)
                _hang_up(request)
            except ConnectionError:
                pass  # whoever looked has left
        return stream

    async def _snapshot(self, request: web.Request) -> web.StreamResponse:
        streams, name = self._admitted(request)
        if request.method == "HEAD":
            return web.Response(headers=HEADERS, content_type="image/jpeg")
        with _looking(streams, name, streams.rate) as eye:
            try:
                async with asyncio.timeout(SNAPSHOT_SECONDS):
                    picture = await eye.after(None)
            except TimeoutError:
                raise web.HTTPServiceUnavailable(text="no picture could be painted in time") from None
        if picture is None:
            raise self._unknown(name)
        headers = {**HEADERS, "X-Timestamp": f"{picture.taken:.6f}"}
        return web.Response(body=picture.jpeg, headers=headers, content_type="image/jpeg")

    def _admitted(self, request: web.Request) -> tuple[Streams, str]:
        """Whose eye the request is for."""
        if "robot" not in request.match_info:  # the whole floor is for everybody
            self._check_crowd(self._overhead)
            return self._overhead, "the camera above"
        # a page would show them to whoever opens it; the relay knows who may see what
        if RELAY_HEADER not in request.headers or "Origin" in request.headers:
            raise web.HTTPForbidden(text="pages get the pictures from the master's relay, not from here")
        robot = request.match_info["robot"]
        if robot not in self._world.robots:
            raise self._unknown(robot)
        self._check_crowd(self._eyes)
        return self._eyes, robot

    def _check_crowd(self, streams: Streams) -> None:
        if streams.lookers >= MAX_CONNECTIONS:
            raise web.HTTPServiceUnavailable(text=f"{MAX_CONNECTIONS} look already")

    def _unknown(self, robot: str) -> web.HTTPNotFound:
        there = ", ".join(sorted(self._world.robots)) or "none"
        return web.HTTPNotFound(text=f"no robot {robot} is on the floor; there are: {there}")

    async def _send(self, request: web.Request, stream: web.StreamResponse, data: bytes) -> None:
        async with asyncio.timeout(SEND_SECONDS):
            await stream.write(data)
            await request.writer.drain()  # write() waits only now and then


@contextlib.contextmanager
def _looking(streams: Streams, name: str, rate: int) -> Iterator[Eye]:
    eye = streams.open(name, rate)
    try:
        yield eye
    finally:
        streams.leave(name, eye, rate)


def _wanted_rate(request: web.Request, full: int) -> int:
    """The pictures/s that the query asks for."""
    rate = request.query.get("rate", str(full))
    if not _RATE.fullmatch(rate) or int(rate) > full:
        raise web.HTTPBadRequest(text=f"rate must be a whole number of pictures a second, from 1 to {full}")
    return int(rate)


def part_of(picture: Picture, full: int) -> bytes:
    """A part of the stream, and the boundary after it. `full` is the most pictures/s that one can ask for."""
    head = f"Content-Type: image/jpeg\r\nContent-Length: {len(picture.jpeg)}\r\nX-Timestamp: {picture.taken:.6f}\r\n"
    return f"{head}{RATE_HEADER}: {full}\r\n\r\n".encode() + picture.jpeg + f"\r\n--{BOUNDARY}\r\n".encode()


def _keep_little(request: web.Request, unsent: int) -> None:
    """Neither this program nor the kernel stores pictures for a slow reader, who gets newer ones instead."""
    if request.transport:
        request.transport.set_write_buffer_limits(0)
        request.transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, unsent)


def _hang_up(request: web.Request) -> None:
    if request.transport:
        request.transport.abort()
