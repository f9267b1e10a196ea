"""The arena seen from above, for anyone: a page, and its state 25 times a second on the WebSocket /view."""

import asyncio
import contextlib
import json
import logging
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from sim.arena.geometry import ROBOT_RADIUS
from sim.arena.light import BEAM_HALF_ANGLE, BEAM_RANGE
from sim.arena.world import World

RATE = 25  # states a second
MAX_VIEWERS = 64
MAX_UNSENT = 16_384  # bytes on the way to one viewer; more would be old states
SEND_SECONDS = 5.0  # for one message; a viewer that takes longer is gone
STATIC = Path(__file__).resolve().parents[1] / "static"

_log = logging.getLogger(__name__)


def arena_message(world: World) -> dict[str, Any]:
    """What does not change; the first message to a viewer."""
    return {
        "type": "arena",
        "width": world.floor.width,
        "height": world.floor.height,
        "walls": world.floor.walls,
        "robot_radius": ROBOT_RADIUS,
        "beam_range": BEAM_RANGE,
        "beam_half_angle": BEAM_HALF_ANGLE,
    }


def state_message(world: World, time: float) -> dict[str, Any]:
    """Everything on the floor at `time` (s since the arena's start), sorted by name."""
    return {
        "type": "state",
        "time": round(time, 3),
        "robots": [
            {
                "name": robot.name,
                "id": robot.id,
                "x": round(robot.pose.x, 4),
                "y": round(robot.pose.y, 4),
                "heading": round(robot.pose.heading, 4),
                "beam": robot.beam,
                "lit": robot.lit,
                "hits": robot.hits,
            }
            for robot in sorted(world.robots.values(), key=lambda robot: robot.name)
        ],
    }


class View:
    """The HTTP side. Every viewer gets the newest state when it can take one; a slow one skips states."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._viewers: set[web.WebSocketResponse] = set()
        self._newest = ""
        self._news = asyncio.Condition()

    def app(self) -> web.Application:
        app = web.Application(middlewares=[_fresh])
        app.router.add_get("/", self._page)
        app.router.add_get("/view", self._view)
        app.router.add_static("/static/", STATIC)
        app.cleanup_ctx.append(self._run_clock)
        app.on_shutdown.append(self._say_goodbye)  # type: ignore[arg-type]  # typed for an older aiosignal
        return app

    async def _say_goodbye(self, _app: web.Application) -> None:
        for viewer in list(self._viewers):
            await viewer.close(code=WSCloseCode.GOING_AWAY)

    async def _run_clock(self, _app: web.Application) -> AsyncIterator[None]:
        clock = asyncio.create_task(self._tick())
        yield
        clock.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await clock

    async def _tick(self) -> None:
        loop = asyncio.get_running_loop()
        start = loop.time()
        while True:
            if self._viewers:
                self._newest = json.dumps(state_message(self._world, loop.time() - start))
                async with self._news:
                    self._news.notify_all()
            await asyncio.sleep(1 / RATE)

    async def _page(self, _request: web.Request) -> web.FileResponse:
        return web.FileResponse(STATIC / "arena.html")

    async def _view(self, request: web.Request) -> web.StreamResponse:
        if len(self._viewers) >= MAX_VIEWERS:
            raise web.HTTPServiceUnavailable(text="too many viewers")
        viewer = web.WebSocketResponse(heartbeat=10, max_msg_size=1024, timeout=1.0, writer_limit=MAX_UNSENT)
        await viewer.prepare(request)
        _keep_little(request)
        self._viewers.add(viewer)
        sender = asyncio.create_task(self._show(viewer))
        try:
            async for message in viewer:  # a viewer has nothing to say; this notices that it leaves
                if message.type == WSMsgType.ERROR:
                    break
        finally:
            self._viewers.discard(viewer)
            sender.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await sender
        return viewer

    async def _show(self, viewer: web.WebSocketResponse) -> None:
        try:
            await self._send(viewer, json.dumps(arena_message(self._world)))
            while not viewer.closed:
                async with self._news:
                    await self._news.wait()
                await self._send(viewer, self._newest)
        except TimeoutError:
            _log.warning("a viewer has stopped reading: disconnected")
            await viewer.close(code=WSCloseCode.TRY_AGAIN_LATER, drain=False)
        except ConnectionError:
            pass  # the viewer has left

    async def _send(self, viewer: web.WebSocketResponse, text: str) -> None:
        async with asyncio.timeout(SEND_SECONDS):
            await viewer.send_str(text)


def _keep_little(request: web.Request) -> None:
    """Keep the kernel from storing many old states for a slow viewer."""
    if request.transport:
        request.transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, MAX_UNSENT)


@web.middleware
async def _fresh(
    request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
) -> web.StreamResponse:
    """Browsers ask whether their copy of the page is still current, so that an update of the arena shows at once."""
    response = await handler(request)
    if not response.prepared:
        response.headers["Cache-Control"] = "no-cache"
    return response
