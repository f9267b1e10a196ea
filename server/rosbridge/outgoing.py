"""The WebSocket messages that one operation becomes."""

import itertools
import os
from collections.abc import Mapping
from typing import Any

from server.messages.types import MessageType
from server.rosbridge.compression import encode
from server.rosbridge.effects import Reply, Response
from server.rosbridge.fragments import split
from server.websocket.frames import frame
from server.websocket.requests import dumps

# What takes longer than a few ms is made outside the event loop.
LARGE, LARGE_BYTES = 64 * 2**10, 2**20  # bytes of a message; what is long by a blob or a text is quick

# operations; a number tells a client which fragments belong together, whichever process made them
_fragmented = itertools.count(os.getpid() * 10**6)


def outgoing(operation: dict[str, Any] | str, compression: str, fragment_size: int | None) -> list[str | bytes]:
    """As `encode` makes it; a text longer than `fragment_size` characters comes in fragments."""
    message = encode(operation, compression)
    if isinstance(message, bytes) or fragment_size is None or len(message) <= fragment_size:
        return [message]
    return list(split(message, fragment_size, str(next(_fragmented))))


def replied(reply: Reply, response: Response) -> list[str | bytes]:
    """A service_response. ConversionError when the response is not what its type says."""
    operation, (message_type, data) = reply.operation, response
    if reply.compression.startswith("cbor"):
        values = message_type.cbor(data)
        return outgoing({**operation, "values": values, "result": True}, reply.compression, reply.fragment_size)
    text = f'{dumps(operation)[:-1]},"values":{message_type.json(data)},"result":true}}'
    return outgoing(text, reply.compression, reply.fragment_size)


def replied_frames(reply: Reply, message_type: MessageType, data: bytes) -> bytes:
    """The same as it goes to the socket."""
    return b"".join(map(frame, replied(reply, Response(message_type, data))))


def asked_frames(operation: Mapping[str, object], message_type: MessageType, data: bytes) -> bytes:
    """A call_service with that request, as it goes to the socket. ConversionError when it is not what its type says."""
    return frame(f'{dumps(operation)[:-1]},"args":{message_type.json(data)}}}')


def takes_long(message_type: MessageType, data: bytes, compression: str) -> bool:
    """Whether to make an operation of that message would keep others waiting."""
    is_quick = compression.startswith("cbor") or (compression == "none" and message_type.is_long_by_bytes)
    return len(data) > (LARGE_BYTES if is_quick else LARGE)
