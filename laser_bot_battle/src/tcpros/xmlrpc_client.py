"""Calls of XML-RPC methods from the event loop: of the ROS master, and of other nodes."""

import asyncio
import xmlrpc.client
from typing import Any
from urllib.parse import urlsplit

from tcpros import sockets

MAX_ANSWER = 16 * 2**20  # bytes
# A larger answer is taken apart beside the event loop, which would stand still meanwhile.
LARGE = 2**16  # bytes


class UnsendableError(ValueError):
    """XML-RPC has no way to say an argument."""


async def call(uri: str, method: str, *arguments: Any, timeout: float) -> Any:
    """What the method returns. OSError when there is no such answer within `timeout` s; UnsendableError."""
    try:
        request = xmlrpc.client.dumps(arguments, method).encode()
    except (OverflowError, TypeError, ValueError, RecursionError) as error:
        raise UnsendableError(str(error)) from None
    load = xmlrpc.client.loads
    try:
        async with asyncio.timeout(timeout):
            answer = await _post(uri, request)
            (value,), _ = load(answer) if len(answer) <= LARGE else await asyncio.to_thread(load, answer)
    except TimeoutError:
        raise TimeoutError(f"{uri} has not answered within {timeout:g} s") from None
    except OSError:
        raise
    except Exception as error:  # the parser raises whatever its input makes it to
        raise OSError(f"{uri} does not answer by XML-RPC: {error}") from None
    return value


async def _post(uri: str, body: bytes) -> bytes:
    place = urlsplit(uri)
    if not place.hostname:
        raise ValueError("it names no host")
    reader, writer = await asyncio.open_connection(place.hostname, place.port or 80)
    try:
        # HTTP/1.0: nothing in the answer but a length and the content
        writer.write(
            f"POST {place.path or '/RPC2'} HTTP/1.0\r\nHost: {place.netloc}\r\nContent-Type: text/xml\r\n"
            f"Content-Length: {len(body)}\r\n\r\n".encode()
            + body
        )
        status, *fields = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1").split("\r\n")
        if status.split(" ")[1:2] != ["200"]:
            raise ValueError(status)
        length = MAX_ANSWER + 1
        for field in fields:
            name, _, value = field.partition(":")
            if name.lower() == "content-length":
                length = int(value)
                if length > MAX_ANSWER:
                    raise ValueError(f"{length} bytes are too many")
                return await reader.readexactly(length)
        return await _read_to_end(reader)
    finally:
        await sockets.end(writer)


async def _read_to_end(reader: asyncio.StreamReader) -> bytes:
    data = bytearray()
    while piece := await reader.read(2**16):
        data += piece
        if len(data) > MAX_ANSWER:
            raise ValueError(f"more than {MAX_ANSWER} bytes")
    return bytes(data)
