"""Long messages in pieces (rosbridge protocol 3.1.1): {"op": "fragment", "id", "data", "num", "total"}."""

import math
import sys
from dataclasses import dataclass, field

from server.websocket.requests import Id, Request, RequestError, dumps

# What a piece holds at least, whatever the client asks for: each has about 60 characters around it.
MIN_FRAGMENT = 32  # characters
MAX_FRAGMENTS = 10_000  # of one message

MAX_SIZE = 8 * 2**20  # bytes of memory, of all unfinished messages of a client
MAX_UNFINISHED = 8  # messages of a client
PATIENCE = 10.0  # s without a piece, after which an unfinished message is forgotten


def split(text: str, fragment_size: int, message_id: Id) -> list[str]:
    """The text, or its fragments when it has more than `fragment_size` characters. That counts what a fragment holds
    before it becomes JSON, as upstream does; too small sizes give way to MIN_FRAGMENT and MAX_FRAGMENTS.
    `message_id`: not None, and unlike that of any other message that is on its way to the client."""
    size = max(fragment_size, MIN_FRAGMENT, math.ceil(len(text) / MAX_FRAGMENTS))
    if len(text) <= size:
        return [text]
    total = math.ceil(len(text) / size)
    return [
        dumps(
            {
                "op": "fragment",
                "id": message_id,
                "data": text[num * size : (num + 1) * size],
                "num": num,
                "total": total,
            }
        )
        for num in range(total)
    ]


@dataclass
class Unfinished:
    """A message of which not all pieces have come."""

    total: int
    heard: float = 0.0  # when its last piece came; monotonic s
    size: int = 0  # bytes of memory
    pieces: dict[int, str] = field(default_factory=dict)


class Reassembly:
    """The unfinished messages of one client."""

    def __init__(self, max_size: int = MAX_SIZE) -> None:
        """`max_size`: bytes of memory for all of them, up to MAX_SIZE."""
        self.max_size = max_size
        self._unfinished: dict[str | int | float, Unfinished] = {}

    def add(self, request: Request, now: float) -> str | None:
        """The message, when this fragment completes it. Pieces may come in any order and more than once. RequestError
        for a fragment that is none, or too much; the latter gives its message up."""
        self.expire(now)
        num, total, data = request.count("num", -1), request.count("total", 0), request.text("data")
        if request.id is None:
            raise RequestError("a fragment needs the id of its message")
        if not 0 <= num < total <= MAX_FRAGMENTS:
            raise RequestError(f"a fragment's num is below its total, and the total is {MAX_FRAGMENTS} at most")
        message = self._message(request.id, total)
        message.heard = now
        if num in message.pieces:
            return None
        message.pieces[num] = data
        message.size += sys.getsizeof(data)
        if sum(other.size for other in self._unfinished.values()) > self.max_size:
            del self._unfinished[request.id]
            raise RequestError(f"unfinished messages have more than {self.max_size} bytes; this one is dropped")
        if len(message.pieces) < total:
            return None
        del self._unfinished[request.id]
        text = "".join(message.pieces[num] for num in range(total))
        # JavaScript's strings are UTF-16, and a cut may go through a character
        return text if text.isascii() else text.encode("utf-16", "surrogatepass").decode("utf-16", "surrogatepass")

    def expire(self, now: float) -> None:
        """Forget the messages of which no piece has come for long."""
        expired = [key for key, message in self._unfinished.items() if now - message.heard >= PATIENCE]
        for key in expired:
            del self._unfinished[key]

    def _message(self, key: str | int | float, total: int) -> Unfinished:
        message = self._unfinished.get(key)
        if message is None:
            if len(self._unfinished) >= MAX_UNFINISHED:
                raise RequestError(f"a client may have {MAX_UNFINISHED} unfinished messages")
            message = self._unfinished[key] = Unfinished(total)
        elif message.total != total:
            raise RequestError(f"the message has {message.total} fragments, not {total}")
        return message
