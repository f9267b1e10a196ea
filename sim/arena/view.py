"""The arena seen from above, for anyone: a page, and its state on the WebSocket /view, up to 25 times a second."""

import asyncio
import contextlib
import hashlib
import json
import logging
import socket
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from laser_bot_battle import subprotocols
from laser_bot_battle.hosts import is_valid_host
from laser_bot_battle.names import FRONT_HEADER
from laser_bot_battle.proxies import FORWARDED, Network, asked, visitor
from sim.arena.cameras.pages import CAMERAS, CameraPages
from sim.arena.geometry import ROBOT_RADIUS
from sim.arena.light import BEAM_HALF_ANGLE, BEAM_RANGE
from sim.arena.policy import page_policy
from sim.arena.viewers import RATE, Clock, Viewer, Viewers
from sim.arena.world import World

MAX_UNSENT = 16_384  # bytes on the way to one viewer; more would be old states
SEND_SECONDS = 5.0  # for one message; a viewer that takes longer is gone
STATIC = Path(__file__).resolve().parents[1] / "static"
HEADERS = {
    "Cache-Control": "no-cache",  # an update of the arena shows at once
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
}
FRONTED = '<meta name="front" content="yes">'  # tells the page that the game is at the same address
KEPT = {"Cache-Control": "public, max-age=31536000, immutable"}

_log = logging.getLogger(__name__)


def _files() -> str:
    """Where the page finds its files, below its own address. Their content gives the name: browsers may keep them."""
    content = b"".join(path.read_bytes() for path in sorted(STATIC.iterdir()))
    return f"static/{hashlib.sha256(content).hexdigest()[:8]}/"


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

    def __init__(self, world: World, rosbridge_port: int, eyes: CameraPages, proxies: Sequence[Network] = ()) -> None:
        """Pages find the game's rosbridge at `rosbridge_port` of the host that they came from. Of `proxies` is believed
        for whom they come."""
        self._world = world
        self._proxies = proxies
        self._eyes = eyes
        self._rosbridge_port = rosbridge_port
        self._files = _files()
        page = (STATIC / "arena.html").read_text()
        self._page_text = page.replace("{{ rosbridge_port }}", str(rosbridge_port)).replace("{{ files }}", self._files)
        self._fronted_text = self._page_text.replace("<meta name", FRONTED + "<meta name", 1)
        self._viewers = Viewers()
        self._open: set[web.WebSocketResponse] = set()
        self._newest = ""
        self._clock = Clock()

    @property
    def viewers(self) -> int:
        """How many look on."""
        return len(self._viewers)

    def app(self) -> web.Application:
        app = web.Application(middlewares=[self._with_headers])
        app.router.add_get("/", self._page)
        app.router.add_get("/view", self._view)
        app.router.add_static(f"/{self._files}", STATIC)
        self._eyes.add_to(app)
        app.cleanup_ctx.append(self._run_clock)
        app.on_shutdown.append(self._say_goodbye)  # type: ignore[arg-type]  # typed for an older aiosignal
        return app

    @web.middleware
    async def _with_headers(
        self, request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        """The answer with the headers of all pages; 400 for a header Host that names none."""
        host = asked(request.remote or "", partial(_header, request), self._proxies).host
        host = "localhost" if host is None else host  # HTTP/1.0 has none
        if not is_valid_host(host):
            raise web.HTTPBadRequest(text="the header Host names no host")
        headers = {"Content-Security-Policy": page_policy(host, self._rosbridge_port), **HEADERS}
        try:
            response = await handler(request)
        except web.HTTPException as refusal:
            refusal.headers.update(headers)
            raise
        if not response.prepared:  # is no WebSocket
            for name, value in headers.items():
                response.headers.setdefault(name, value)  # the eyes' pictures have an own Cache-Control
            if request.path.startswith(f"/{self._files}"):
                response.headers.update(KEPT)
            if not request.path.startswith(CAMERAS):  # those are compressed already
                response.enable_compression()  # page and scripts take a third of their size
        return response

    async def _say_goodbye(self, _app: web.Application) -> None:
        for socket_ in list(self._open):
            await socket_.close(code=WSCloseCode.GOING_AWAY)

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
                self._newest = json.dumps(state_message(self._world, loop.time(), start))
                self._clock.tick()
            await asyncio.sleep(1 / RATE)

    async def _page(self, request: web.Request) -> web.Response:
        text = self._fronted_text if FRONT_HEADER in request.headers else self._page_text
        return web.Response(text=text, content_type="text/html")

    async def _view(self, request: web.Request) -> web.StreamResponse:
        address = visitor(request.remote or "", _header(request, FORWARDED), self._proxies)
        if reason := self._viewers.refusal(address):
            raise web.HTTPServiceUnavailable(text=reason)
        subprotocol = subprotocols.chosen(request.headers.getall(subprotocols.HEADER, []))
        # uncompressed: each viewer would cost the time to compress every state anew
        opened = web.WebSocketResponse(
            heartbeat=10,
            max_msg_size=1024,
            timeout=1.0,
            writer_limit=MAX_UNSENT,
            compress=False,
            protocols=[subprotocol] if subprotocol else [],
        )
        viewer = Viewer(address)
        self._viewers.add(viewer)
        self._open.add(opened)
        sender = None
        try:
            await opened.prepare(request)
            _keep_little(request)
            sender = asyncio.create_task(self._show(opened, viewer))
            async for message in opened:
                if message.type == WSMsgType.TEXT:
                    self._viewers.hear(viewer, message.data)
                elif message.type == WSMsgType.ERROR:
                    break
        finally:
            self._viewers.remove(viewer)
            self._open.discard(opened)
            if sender:
                sender.cancel()
                with contextlib.suppress(asyncio.CancelledError):
                    await sender
        return opened

    async def _show(self, opened: web.WebSocketResponse, viewer: Viewer) -> None:
        try:
            await self._send(opened, json.dumps(arena_message(self._world)))
            while not opened.closed:
                await self._clock.wait(viewer)
                await self._send(opened, self._newest)
        except TimeoutError:
            _log.warning("a viewer has stopped reading: disconnected")
            await opened.close(code=WSCloseCode.TRY_AGAIN_LATER, drain=False)
        except ConnectionError:
            pass  # the viewer has left

    async def _send(self, opened: web.WebSocketResponse, text: str) -> None:
        async with asyncio.timeout(SEND_SECONDS):
            await opened.send_str(text)


def _header(request: web.Request, name: str) -> str | None:
    """Its value, of several with commas between them; None without one."""
    return ", ".join(request.headers.getall(name)) if name in request.headers else None


def _keep_little(request: web.Request) -> None:
    """Keep the kernel from storing many old states for a slow viewer."""
    if request.transport:
        request.transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, MAX_UNSENT)
