"""The WebSocket server: listens, looks after all its clients, and says goodbye."""

import asyncio
import contextlib
import socket
from collections.abc import Sequence
from types import TracebackType
from typing import Self

from websockets.frames import CloseCode

from laser_bot_battle.listening import Listener
from laser_bot_battle.open_files import allow_files
from laser_bot_battle.openings import OPEN_TIMEOUT, Openings
from laser_bot_battle.proxies import Network
from server.websocket.connection import CLOSE_TIMEOUT
from server.websocket.limits import Limits, SocketLimits
from server.websocket.opening import Identify, Opening
from server.websocket.scheduling import Scheduler
from server.websocket.server_state import Bridge, ServerState

TICK = 0.5  # s between two looks at all clients
# A tick that comes so late says that the loop, or the whole machine, stood still.
LATE = 0.5  # s
BACKLOG = 256  # connections that the kernel holds until they are accepted
# What the kernel may hold for a slow client. More would only make its news older.
SEND_BUFFER = 64 * 2**10  # bytes
ACCEPTED = 0.01  # s until all that were accepted before the end are known
SPARE_FILES = 500  # beside the clients' sockets: those of ROS above all


class WebSocketServer:
    """Listens while in an `async with`."""

    def __init__(
        self,
        bridge: Bridge,
        listener: Listener,
        identify: Identify,
        limits: Limits | None = None,
        proxies: Sequence[Network] = (),
    ) -> None:
        """`listener` is bound, and not listening yet. `identify` tells who sends a handshake. Of `proxies` is believed
        for whom they come."""
        self._bridge, self._listener, self._identify = bridge, listener, identify
        self._proxies = proxies
        self._limits = limits or Limits()
        self._state: ServerState
        self._servers: list[asyncio.Server] = []
        self._timer: asyncio.TimerHandle
        self._next_tick = 0.0

    async def __aenter__(self) -> Self:
        """OSError when the port cannot be had."""
        loop = asyncio.get_running_loop()
        openings = Openings(self._limits.all_opening, self._limits.opening)
        sockets = SocketLimits(self._limits)
        self._state = ServerState(loop, self._bridge, sockets, Scheduler(loop), openings, self._proxies)
        allow_files(self._limits.clients + self._limits.all_opening + SPARE_FILES)
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)  # its connections inherit it
        for each in self._listener.sockets:
            self._servers.append(await loop.create_server(self._open, sock=each, backlog=BACKLOG))
        self._next_tick = loop.time() + TICK
        self._timer = loop.call_at(self._next_tick, self._tick)
        return self

    async def __aexit__(self, kind: type[BaseException] | None, value: object, trace: TracebackType | None) -> None:
        """Close all sockets with 1001."""
        self._timer.cancel()
        for server in self._servers:
            server.close()
        self._state.ending = True
        for opening in self._state.openings:
            opening.cut()
        for connection in list(self._state.connections):
            connection.close(CloseCode.GOING_AWAY)
        await asyncio.sleep(ACCEPTED)
        self._state.left()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._state.empty.wait(), 2 * CLOSE_TIMEOUT)
        for server in self._servers:
            await server.wait_closed()

    def _open(self) -> Opening:
        return Opening(self._state, self._identify)

    def _tick(self) -> None:
        now = self._state.loop.time()
        late = now - self._next_tick
        self._next_tick = now + TICK
        self._timer = self._state.loop.call_at(self._next_tick, self._tick)
        for connection in list(self._state.connections):
            if late > LATE:
                connection.extend_deadlines(late)
            connection.check(now)
        self._state.openings.cut_older(now - OPEN_TIMEOUT)
