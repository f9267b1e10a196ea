"""Whether a ROS master answers at an address that anybody may have announced: bounded in time and in memory."""

import asyncio
import contextlib
import xmlrpc.client
from typing import Any
from xml.parsers.expat import ExpatError

ANSWER = 1.0  # s
MAX_ANSWER = 4096  # bytes

_CALL = xmlrpc.client.dumps(("/arena_search",), "getPid")


async def is_master(address: str, port: int) -> bool:
    """Ask for its process ID, as wiki.ros.org/ROS/Master_API says."""
    try:
        async with asyncio.timeout(ANSWER):
            answer = await _ask(address, port)
        values: tuple[Any, ...] = xmlrpc.client.loads(answer.partition(b"\r\n\r\n")[2])[0]
        code, _, _ = values[0]
    except (OSError, xmlrpc.client.Error, ExpatError, ArithmeticError, LookupError, TypeError, ValueError):
        return False
    return bool(code == 1)


async def _ask(address: str, port: int) -> bytes:
    """The whole answer, with its head."""
    reader, writer = await asyncio.open_connection(address, port)
    try:
        writer.write(
            f"POST /RPC2 HTTP/1.0\r\nHost: {address}:{port}\r\nContent-Type: text/xml\r\n"
            f"Content-Length: {len(_CALL)}\r\n\r\n{_CALL}".encode()
        )
        try:
            await reader.readexactly(MAX_ANSWER)
        except asyncio.IncompleteReadError as end:
            return end.partial
        raise ValueError("it says too much")
    finally:
        writer.close()
        with contextlib.suppress(OSError):
            await writer.wait_closed()
