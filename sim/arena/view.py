"""The arena seen from above, for developers and what stands for a camera: a page, and what is true on the floor on the
WebSocket /view, 30 times a second. Players' pages draw from /positions instead."""

import asyncio
import contextlib
import json
import logging
import socket
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from pathlib import Path
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from laser_bot_battle.geometry import ROBOT_RADIUS
from laser_bot_battle.openings import OF_ADDRESS
from laser_bot_battle.proxies import FORWARDED, Network, visitor
from sim.arena.cameras.pages import CameraPages
from sim.arena.light import BEAM_HALF_ANGLE, BEAM_RANGE
from sim.arena.world import World

RATE = 30  # states a second
MAX_VIEWERS = 64
MAX_UNSENT = 16_384  # bytes on the way to one viewer; more would be old states
SEND_SECONDS = 5.0  # for one message; a viewer that takes longer is gone
STATIC = Path(__file__).resolve().parents[1] / "static"
DRAWING = Path(__file__).resolve().parents[2] / "server" / "static" / "js" / "arena"  # as on the players' pages
HEADERS = {
    "Content-Security-Policy": "default-src 'self'; connect-src 'self' ws: wss:; frame-ancestors 'none'",
    "Cache-Control": "no-cache",  # an update of the arena shows at once
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
}

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


def state_message(world: World, now: float, start: float = 0.0) -> dict[str, Any]:
    """Everything on the floor at `now`, sorted by name; its time counts from `start` (s of the arena's clock)."""
    return {
        "type": "state",
        "time": round(now - start, 3),
        "robots": [
            {
                "name": robot.name,
                "id": robot.id,
                "x": round(robot.pose.x, 4),
                "y": round(robot.pose.y, 4),
                "heading": round(robot.pose.heading, 4),
                "beam": robot.is_shining(now),
                "lit": robot.is_lit(now),
                "hits": robot.hits,
            }
            for robot in sorted(world.robots.values(), key=lambda robot: robot.name)
        ],
    }


class View:
    """The HTTP side. Every viewer gets the newest state when it can take one; a slow one skips states."""

    def __init__(self, world: World, eyes: CameraPages, proxies: Sequence[Network] = ()) -> None:
        """Of `proxies` is believed for whom they come."""
        self._world = world
        self._proxies = proxies
        self._eyes = eyes
        self._open: dict[web.WebSocketResponse, str] = {}  # with the viewers' addresses
        self._newest = ""
        self._tick = asyncio.Event()  # the next one

    @property
    def viewers(self) -> int:
        """How many look on."""
        return len(self._open)

    def app(self) -> web.Application:
        app = web.Application(middlewares=[self._with_headers])
        app.router.add_get("/", self._page)
        app.router.add_get("/view", self._view)
        app.router.add_static("/static/", STATIC)
        app.router.add_static("/drawing/", DRAWING)
        self._eyes.add_to(app)
        app.cleanup_ctx.append(self._run_clock)
        app.on_shutdown.append(self._say_goodbye)  # type: ignore[arg-type]  # typed for an older aiosignal
        return app

    @web.middleware
    async def _with_headers(
        self, request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        """The answer with the headers of all pages."""
        try:
            response = await handler(request)
        except web.HTTPException as refusal:
            refusal.headers.update(HEADERS)
            raise
        if not response.prepared:  # is no WebSocket
            for name, value in HEADERS.items():
                response.headers.setdefault(name, value)  # the eyes' pictures have an own Cache-Control
        return response

    async def _say_goodbye(self, _app: web.Application) -> None:
        for socket_ in list(self._open):
            await socket_.close(code=WSCloseCode.GOING_AWAY)

    async def _run_clock(self, _app: web.Application) -> AsyncIterator[None]:
        clock = asyncio.create_task(self._follow())
        yield
        clock.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await clock

    async def _follow(self) -> None:
        loop = asyncio.get_running_loop()
        start = loop.time()
        while True:
            if self._open:
                self._newest = json.dumps(state_message(self._world, loop.time(), start))
                self._tick.set()
                self._tick = asyncio.Event()
            await asyncio.sleep(1 / RATE)

    async def _page(self, _request: web.Request) -> web.FileResponse:
        return web.FileResponse(STATIC / "arena.html")

    def _refusal(self, address: str) -> str:
        """Why there is no room for another viewer from there; empty when there is."""
        if list(self._open.values()).count(address) >= OF_ADDRESS:
            return f"{OF_ADDRESS} viewers have your address already"
        return f"{MAX_VIEWERS} look on already" if len(self._open) >= MAX_VIEWERS else ""

    async def _view(self, request: web.Request) -> web.StreamResponse:
        address = visitor(request.remote or "", ", ".join(request.headers.getall(FORWARDED, [])), self._proxies)
        if reason := self._refusal(address):
            raise web.HTTPServiceUnavailable(text=reason)
        # uncompressed: each viewer would cost the time to compress every state anew
        opened = web.WebSocketResponse(
            heartbeat=10,
            max_msg_size=1024,
            timeout=1.0,
            writer_limit=MAX_UNSENT,
            compress=False,
        )
        self._open[opened] = address
        sender = None
        try:
            await opened.prepare(request)
            _keep_little(request)
            sender = asyncio.create_task(self._show(opened))
            async for message in opened:
                if message.type == WSMsgType.ERROR:
                    break
        finally:
            del self._open[opened]
            if sender:
                sender.cancel()
                with contextlib.suppress(asyncio.CancelledError):
                    await sender
        return opened

    async def _show(self, opened: web.WebSocketResponse) -> None:
        try:
            await self._send(opened, json.dumps(arena_message(self._world)))
            while not opened.closed:
                await self._tick.wait()
                await self._send(opened, self._newest)
        except TimeoutError:
            _log.warning("a viewer has stopped reading: disconnected")
            await opened.close(code=WSCloseCode.TRY_AGAIN_LATER, drain=False)
        except ConnectionError:
            pass  # the viewer has left

    async def _send(self, opened: web.WebSocketResponse, text: str) -> None:
        async with asyncio.timeout(SEND_SECONDS):
            await opened.send_str(text)


def _keep_little(request: web.Request) -> None:
    """Keep the kernel from storing many old states for a slow viewer."""
    if request.transport:
        request.transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, MAX_UNSENT)
