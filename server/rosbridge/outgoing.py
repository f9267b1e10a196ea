"""The WebSocket messages that one operation becomes."""

import itertools
from typing import Any

from server.rosbridge.compression import encode
from server.rosbridge.fragments import split

_fragmented = itertools.count(1)  # operations; a number tells a client which fragments belong together


def outgoing(operation: dict[str, Any] | str, compression: str, fragment_size: int | None) -> list[str | bytes]:
    """As `encode` makes it; a text longer than `fragment_size` characters comes in fragments."""
    message = encode(operation, compression)
    if isinstance(message, bytes) or fragment_size is None or len(message) <= fragment_size:
        return [message]
    return list(split(message, fragment_size, str(next(_fragmented))))
