"""Calls of services of other nodes."""

import asyncio
import socket
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import contextmanager
from types import MappingProxyType
from typing import Any
from urllib.parse import urlsplit

from laser_bot_battle.master import MasterError
from tcpros import sockets
from tcpros.header import LENGTH, HeaderError
from tcpros.service import read_block
from tcpros.specs import ANY, ServiceError

MakeRequest = Callable[[Mapping[str, str]], Awaitable[bytes]]


class ServiceCaller:
    """Calls in the name of the node `callerid`; `master` calls the ROS master."""

    def __init__(self, callerid: str, master: Callable[..., Awaitable[Any]]) -> None:
        self._callerid = callerid
        self._master = master

    async def call(
        self,
        service: str,
        make_request: MakeRequest,
        timeout: float,
        md5sum: str,
        fields: Mapping[str, str] = MappingProxyType({}),
    ) -> tuple[bytes, Mapping[str, str]]:
        """See Node.call. `fields` are further ones of the connection's header."""
        with service_errors(timeout):
            async with asyncio.timeout(timeout):
                connected, header = await self._connect(service, md5sum=md5sum, **fields)
                try:
                    request = await make_request(header)
                except BaseException:
                    connected.close()
                    raise
                succeeded, answer = await _exchange(connected, request)
        if not succeeded:
            raise ServiceError(answer.decode(errors="replace") or "the service failed")
        return answer, header

    async def probe(self, service: str, timeout: float) -> Mapping[str, str]:
        """See Node.probe."""
        with service_errors(timeout):
            async with asyncio.timeout(timeout):
                connected, header = await self._connect(service, md5sum=ANY, probe="1")
        connected.close()
        return header

    async def _connect(self, service: str, **fields: str) -> tuple[socket.socket, Mapping[str, str]]:
        """A connection on which both sides have said their headers, and the service's."""
        connected = await sockets.connect(*await self._look_up(service))
        try:
            await sockets.send_header(connected, {"callerid": self._callerid, "service": service, **fields})
            header = await sockets.read_header(connected)
            if "error" in header:
                raise ServiceError(header["error"])
        except BaseException:
            connected.close()
            raise
        return connected, header

    async def _look_up(self, service: str) -> tuple[str, int]:
        try:
            uri = str(await self._master("lookupService", service))
        except MasterError:
            raise ServiceError("there is no such service") from None
        except OSError as error:
            raise ServiceError(f"the ROS master does not answer: {error}") from None
        try:
            place = urlsplit(uri)
            if place.hostname and place.port:
                return place.hostname, place.port
        except ValueError:
            pass
        raise ServiceError(f"the ROS master names an impossible address: {uri}")


@contextmanager
def service_errors(timeout: float) -> Iterator[None]:
    """What goes wrong with the network becomes a ServiceError."""
    try:
        yield
    except TimeoutError:
        raise ServiceError(f"no response within {timeout:g} s") from None
    except HeaderError as error:
        raise ServiceError(f"the service does not speak TCPROS: {error}") from None
    except (OSError, EOFError) as error:
        raise ServiceError(f"the connection to the service broke: {error}") from None


async def _exchange(connected: socket.socket, request: bytes) -> tuple[bool, bytes]:
    """Whether the service succeeded, and its response, or its error text. Takes the socket over."""
    reader, writer = await sockets.streams(connected)
    try:
        writer.write(LENGTH.pack(len(request)) + request)
        succeeded = await reader.readexactly(1)
        return succeeded != b"\0", await read_block(reader)
    finally:
        await sockets.end(writer)
