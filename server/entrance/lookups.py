"""The addresses of arenas' hosts. A name server that does not answer for one of them holds up no other: each name is
asked for once at a time, in a thread that nobody waits for."""

import asyncio
import contextlib
import socket
import threading
from collections.abc import Callable
from typing import Any

LookUp = Callable[..., list[tuple[Any, ...]]]  # as socket.getaddrinfo


class Lookups:
    """For one event loop."""

    def __init__(self, look_up: LookUp = socket.getaddrinfo) -> None:
        self._look_up = look_up
        self._asked: dict[tuple[str, int], asyncio.Future[list[str]]] = {}

    async def addresses(self, host: str, port: int) -> list[str]:
        """All that the name has. OSError if there is none; whoever waits no longer leaves the question to the next."""
        key = host, port
        asked = self._asked.get(key)
        if asked is None:
            asked = self._asked[key] = asyncio.get_running_loop().create_future()
            asked.add_done_callback(lambda _: self._asked.pop(key))
            threading.Thread(target=self._ask, args=[asked, host, port], name=f"look up {host}", daemon=True).start()
        return await asyncio.shield(asked)

    def _ask(self, asked: "asyncio.Future[list[str]]", host: str, port: int) -> None:
        """In the thread."""
        found: list[str] | OSError
        try:
            found = [str(place[4][0]) for place in self._look_up(host, port, type=socket.SOCK_STREAM)]
        except (OSError, UnicodeError) as error:
            found = OSError(f"nobody knows {host}: {error}")

        def tell() -> None:
            if isinstance(found, OSError):
                asked.set_exception(found)
                asked.exception()  # nobody may wait for it any more
            else:
                asked.set_result(found)

        with contextlib.suppress(RuntimeError):  # the loop is closed
            asked.get_loop().call_soon_threadsafe(tell)
