"""One client's WebSocket, which may be slow, rude or dead."""

import asyncio
import contextlib
import logging
import socket
import struct
from typing import Any

from websockets.frames import Close, CloseCode

from server.access.identity import Identity
from server.websocket.frames import FrameError, Frames, Ping, Pong, close_frame, frame, ping_frame, pong_frame
from server.websocket.limits import SocketOwner
from server.websocket.outbox import Outbox
from server.websocket.requests import one_line
from server.websocket.server_state import READ, ServerState

_log = logging.getLogger(__name__)

MAX_MESSAGE = 8 * 2**20  # bytes, of an operator; longer messages close the socket with 1009
MAX_MESSAGE_OF_OTHERS = 64 * 2**10  # bytes
# Replies that wait for a client which does not read them. An operator calls services whose answers are long.
MAX_REPLIES = 64 * 2**20  # bytes, of an operator
MAX_REPLIES_OF_OTHERS = 128 * 2**10  # bytes
# What the transport may hold for a slow client beside the kernel. More would only make its news older.
WRITE_LIMIT = 4 * 2**10  # bytes
STALL = 5.0  # s in which a client has taken nothing at all: it is given up
PING_INTERVAL = 5.0  # s; a client of whom nothing has come from one ping to the next is dead
# A lab's small device may answer no ping, and speak once in a while.
PING_INTERVAL_OF_OPERATORS = 30.0  # s
CLOSE_TIMEOUT = 1.0  # s for the other side to agree to the end
# What one client may have handled before the others get their turn.
TURN_MESSAGES = 16
TURN_BYTES = 32 * 2**10
TURN_CONTROLS = 32
MAX_CONTROLS = 500  # pings and pongs from one `check` to the next
# So much of a player or operator is handled at once, whatever others send.
URGENT = 4 * 2**10  # bytes

_PING = ping_frame()


class Connection(asyncio.BufferedProtocol):
    """What cannot be sent at once waits in a bounded outbox."""

    __slots__ = (
        "_blocked",
        "_client",
        "_closing",
        "_controls",
        "_cut",
        "_end",
        "_frames",
        "_heard",
        "_held",
        "_max_replies",
        "_moved",
        "_outbox",
        "_owner",
        "_ping_at",
        "_pong",
        "_state",
        "_transport",
        "_unsent",
        "address",
        "name",
    )  # fmt: skip

    def __init__(self, state: ServerState, transport: asyncio.Transport, address: str, owner: SocketOwner) -> None:
        """The handshake of `transport` is done. `address` is the visitor's or the proxy's. `owner` may have one more
        socket, which is this one until it has gone."""
        _, port, *_ = transport.get_extra_info("peername") or ("nobody", 0)
        self.address = address
        self.name = f"{address}:{port}"
        self._state, self._transport = state, transport
        self._frames = Frames(MAX_MESSAGE_OF_OTHERS)
        self._outbox: Outbox | None = None  # few clients ever need one
        self._pong: bytes | None = None  # that waits as well; only the newest
        self._blocked = False  # nothing can be sent now
        self._closing = False  # nothing is received any more, and nothing sent
        self._cut: asyncio.TimerHandle | None = None
        self._client: Any = None
        self._end = "the connection is lost"
        self._controls = 0
        self._heard = True  # since the last ping
        self._held = False  # nothing more is handled before what is under way
        now = state.loop.time()
        self._ping_at = now + PING_INTERVAL
        self._moved, self._unsent = now, 0  # when something was taken, and what was not
        transport.set_write_buffer_limits(high=WRITE_LIMIT)
        state.sockets.take(owner)
        state.connections.add(self)
        self._owner = owner
        self._trust()

    @property
    def owner(self) -> SocketOwner:
        return self._owner

    def move(self, owner: SocketOwner) -> None:
        """The client has turned out to be somebody else: the socket is that owner's, if it may have one more."""
        if owner != self._owner and self in self._state.connections:
            self._owner = self._state.sockets.change(self._owner, owner)
            self._trust()

    @property
    def _is_operator(self) -> bool:
        return self._owner.known and self._owner.holder is None

    def _trust(self) -> None:
        self._frames.max_message = MAX_MESSAGE if self._is_operator else MAX_MESSAGE_OF_OTHERS
        self._max_replies = MAX_REPLIES if self._is_operator else MAX_REPLIES_OF_OTHERS

    # ---- what is sent ----

    @property
    def is_blocked(self) -> bool:
        """Whether what is sent now would have to wait, or be dropped."""
        return self._blocked

    def reply(self, data: str | bytes, *rest: str | bytes) -> None:
        """One answer, which may be several messages. A client that leaves too many unread is given up."""
        framed = b"".join(map(frame, (data, *rest))) if rest else frame(data)
        if not self._blocked:
            self._transport.write(framed)
        elif not self._closing:
            outbox = self._waiting()
            outbox.reply(framed)
            if outbox.exceeds(self._max_replies):
                self._give_up("it does not read what it has asked for")

    def message(self, topic: str, framed: bytes, queue_length: int) -> None:
        """A message of a topic, as `frame` makes it; while the client is slow, the newest `queue_length` are kept, 0:
        as many as have room."""
        if not self._blocked:
            self._transport.write(framed)
        elif not self._closing:
            self._waiting().message(topic, framed, queue_length)

    def close(self, code: int, reason: str = "") -> None:
        """Tell the client, and hear nothing more of it."""
        self._shut(code, reason, f"closed with {code} {reason}")

    def log(self, text: str, level: int = logging.INFO) -> None:
        """A line about this client for the operator, unless there have been too many of late."""
        self._state.log(self.address, f"{self.name}: {text}", level)

    def check(self, now: float) -> None:
        """To be called twice a second: is it alive, and does it read?"""
        if self._closing:
            return
        self._controls = 0
        if self._blocked:
            unsent = self._transport.get_write_buffer_size()
            if unsent != self._unsent:
                self._moved, self._unsent = now, unsent
            elif now - self._moved > STALL:
                self._give_up(f"it has not read for {STALL:g} s")
        elif now >= self._ping_at:
            interval = PING_INTERVAL_OF_OPERATORS if self._is_operator else PING_INTERVAL
            if not (self._heard or self._held):
                self._give_up(f"nothing was heard of it for {interval:g} s after a ping")
                return
            self._heard, self._ping_at = False, now + interval
            self._transport.write(_PING)

    def extend_deadlines(self, seconds: float) -> None:
        """The loop stood still for so long, and the client may have done all that it should."""
        self._ping_at += seconds
        self._moved += seconds

    def _waiting(self) -> Outbox:
        if self._outbox is None:
            self._outbox = Outbox()
        return self._outbox

    def pause_writing(self) -> None:
        """The transport is full."""
        self._blocked, self._unsent = True, -1

    def resume_writing(self) -> None:
        if self._closing:
            return
        self._blocked = False
        if self._pong is not None:
            pong, self._pong = self._pong, None
            self._transport.write(pong_frame(pong))
        while self._outbox and not self._blocked:
            self._transport.write(self._outbox.next())
        if not self._outbox:
            self._outbox = None

    # ---- what is received ----

    def begin(self, identity: Identity, data: bytes) -> None:
        """`data` came with the handshake."""
        self._client = self._state.bridge.connected(self, identity)
        self.log("connected")
        if data:
            self._frames.feed(data)
            self._handle(whole=True)

    def get_buffer(self, sizehint: int) -> memoryview:
        return self._state.scratch

    def buffer_updated(self, count: int) -> None:
        if self._closing:
            return
        self._heard = True
        self._frames.feed(self._state.scratch[:count])
        # uvloop reads a socket again and again in one turn for as long as it fills the buffer
        self._handle(whole=count < READ)

    def _handle(self, whole: bool) -> None:
        """Handle what has come, or have it wait; `whole`: the socket had no more."""
        scheduler = self._state.scheduler
        urgent = self._owner.known and self._frames.pending <= URGENT
        if not scheduler.run(self, urgent) or not whole:
            self._transport.pause_reading()
            scheduler.wait(self)

    def work(self) -> bool:
        """Handle as much as one turn allows."""
        controls = messages = size = 0
        take, received = self._frames.take, self._state.bridge.received
        try:
            while not (self._closing or self._held):
                message = take()
                if message is None:
                    return True
                if isinstance(message, str | bytes):
                    received(self._client, message)
                    messages += 1
                    size += len(message)
                else:
                    self._control(message)
                    controls += 1
                if messages >= TURN_MESSAGES or size >= TURN_BYTES or controls >= TURN_CONTROLS:
                    return False
        except FrameError as error:
            self.close(error.code, error.reason)
        except Exception:  # this client's message, and nobody else's trouble
            _log.exception("%s: a message could not be handled", self.name)
            self.close(CloseCode.INTERNAL_ERROR)
        return True

    def hold(self) -> None:
        """Handle no further message until `release`."""
        self._held = True
        self._transport.pause_reading()

    def release(self) -> None:
        self._held = False
        if not self._closing:
            self._state.scheduler.wait(self)

    def resume(self) -> None:
        if self._held:
            return
        self._heard = True  # it was not listened to meanwhile
        self._transport.resume_reading()

    def _control(self, message: Ping | Pong | Close) -> None:
        if isinstance(message, Close):
            code = CloseCode.NORMAL_CLOSURE if message.code == CloseCode.NO_STATUS_RCVD else message.code
            self._shut(code, "", f"closed by the client with {message.code} {one_line(message.reason)}")
            return
        self._controls += 1
        if self._controls > MAX_CONTROLS:
            raise FrameError(1008, "too many pings and pongs")
        if isinstance(message, Pong):
            return
        if self._blocked:
            self._pong = message.data
        else:
            self._transport.write(pong_frame(message.data))

    # ---- the end ----

    def _shut(self, code: int, reason: str, end: str) -> None:
        """Both sides say that they close, and stop sending; the client is to close the socket in time."""
        if self._closing:
            return
        self._closing = self._blocked = True
        self._end, self._outbox = end, None
        self._transport.write(close_frame(code, reason))
        with contextlib.suppress(OSError):  # the other side has gone, and has answered the frame with a reset
            self._transport.write_eof()
        # a socket closed with unread data would be reset, and the close frame lost
        self._transport.resume_reading()
        self._cut = self._state.loop.call_later(CLOSE_TIMEOUT, self._transport.abort)
        self._state.loop.call_soon(self._leave)  # not within a call of the bridge

    def _give_up(self, reason: str) -> None:
        self._closing = self._blocked = True
        self._end, self._outbox = f"given up, {reason}", None
        self.log(self._end, logging.WARNING)
        # reset the connection: the kernel shall not go on with what it still holds for this client
        own = self._transport.get_extra_info("socket")
        own.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self._transport.abort()

    def eof_received(self) -> bool:
        """The transport closes the socket."""
        return False

    def connection_lost(self, error: Exception | None) -> None:
        self._closing = self._blocked = True
        if self._cut is not None:
            self._cut.cancel()
        self._leave()
        self._state.sockets.leave(self._owner)
        self._state.connections.discard(self)
        self._state.left()

    def _leave(self) -> None:
        if self._client is not None:
            client, self._client = self._client, None
            self.log(f"disconnected: {self._end}")
            self._state.bridge.disconnected(client)
