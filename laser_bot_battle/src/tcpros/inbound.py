"""Peers that connect to this node: subscribers to its topics and callers of its services."""

import asyncio
import logging
import socket
from collections.abc import Mapping

from laser_bot_battle.listening import Listener
from tcpros import sockets
from tcpros.header import HeaderError
from tcpros.publisher import Publisher
from tcpros.service import Service
from tcpros.specs import ANY

_log = logging.getLogger(__name__)

# Peers that have connected and not yet said what they want.
MAX_GREETING = 200
ACCEPT_AGAIN = 1.0  # s after that was impossible


class Inbound:
    """Greets every peer and gives it to the publisher or service that it wants, by name."""

    def __init__(self, node: str, publishers: Mapping[str, Publisher], services: Mapping[str, Service]) -> None:
        self._node, self._publishers, self._services = node, publishers, services
        self._greeting = 0
        self._listener: Listener | None = None
        self._tasks: set[asyncio.Task[None]] = set()
        self._ungreeted: set[socket.socket] = set()  # their tasks have not begun yet

    def start(self) -> int:
        """Listen; returns the port. OSError when the address of this machine is impossible."""
        self._listener = sockets.listen()
        for each in self._listener.sockets:
            asyncio.get_running_loop().add_reader(each, self._accept, each)
        return int(self._listener.getsockname()[1])

    async def close(self) -> None:
        if self._listener:
            for each in self._listener.sockets:
                asyncio.get_running_loop().remove_reader(each)
            self._listener.close()
            self._listener = None
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        for connected in self._ungreeted:
            connected.close()

    def _keep(self, task: asyncio.Task[None]) -> None:
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def _accept(self, listener: socket.socket) -> None:
        """Somebody has come. A task that waits for this would lose a connection that comes as it is cancelled."""
        try:
            connected, _ = listener.accept()
        except BlockingIOError:
            return
        except OSError as error:
            _log.warning("%s cannot accept a connection: %s", self._node, error)
            loop = asyncio.get_running_loop()
            loop.remove_reader(listener)
            loop.call_later(ACCEPT_AGAIN, self._accept_again, listener)
            return
        if self._greeting + len(self._ungreeted) >= MAX_GREETING:
            connected.close()
            return
        connected.setblocking(False)
        self._ungreeted.add(connected)
        self._keep(asyncio.get_running_loop().create_task(self._serve(connected)))

    def _accept_again(self, listener: socket.socket) -> None:
        if self._listener:
            asyncio.get_running_loop().add_reader(listener, self._accept, listener)

    async def _serve(self, connected: socket.socket) -> None:
        self._ungreeted.remove(connected)
        self._greeting += 1
        try:
            async with asyncio.timeout(sockets.GREETING):
                header, wanted = await self._greet(connected)
        except (OSError, HeaderError) as error:
            _log.debug("%s: a connection came to nothing: %s", self._node, error)
            wanted = None
        except asyncio.CancelledError:
            connected.close()
            raise
        finally:
            self._greeting -= 1
        if isinstance(wanted, Publisher) and self._publishers.get(wanted.topic) is wanted:
            wanted.add(connected, header)
        elif isinstance(wanted, Service) and header.get("probe") != "1":
            await wanted.accept(connected, header)
        else:
            connected.close()

    async def _greet(self, connected: socket.socket) -> tuple[Mapping[str, str], Publisher | Service | None]:
        """Exchange headers; None when the peer does not get what it wants."""
        sockets.tune(connected)
        header = await sockets.read_header(connected)
        topic, service = header.get("topic"), header.get("service")
        wanted = self._publishers.get(topic) if topic else self._services.get(service or "")
        if wanted and not (error := refusal(header, wanted)):
            await sockets.send_header(connected, wanted.header(self._node))
            return header, wanted
        if not wanted:
            error = f"{self._node} does not offer {topic or service or 'what has no name'}"
        _log.info("%s refuses %.100r: %.300r", self._node, header.get("callerid"), error)
        await sockets.send_header(connected, {"error": error})
        return header, None


def refusal(header: Mapping[str, str], wanted: Publisher | Service) -> str:
    """Why the peer does not get it; empty when it does."""
    for field in ("md5sum", "callerid"):
        if field not in header:
            return f"the header lacks {field}"
    if header["md5sum"] in (ANY, wanted.spec.md5sum):
        return ""
    theirs = f"{header.get('type', '?')} ({header['md5sum']})"
    return f"it is {wanted.spec.name} ({wanted.spec.md5sum}) here, not {theirs}"
