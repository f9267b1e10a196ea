"""What a stranger, or a rude player, can do to a rosbridge: `python -m tests.integration.rosbridge.attacks NAME PORT`.

Each attack goes on until its process is ended, and begins again when the server has closed its socket.
"""

import contextlib
import itertools
import os
import select
import sys
import time
from collections.abc import Callable, Iterator, Mapping

from server.rosbridge.compression import encode
from tests.integration.rosbridge.drivers import VILLAIN, token
from tests.support.bare import CONTINUATION, PING, PONG, BareClient, frame, text_of


class Rude(BareClient):
    """A WebSocket that nobody looks after."""

    def __init__(self, port: int, headers: Mapping[str, str] | None = None) -> None:
        super().__init__(port, headers)
        self.socket.settimeout(1)

    def flood(self, data: bytes, reads: bool = True) -> None:
        """OSError when the server has had enough, or takes nothing for a second."""
        left = memoryview(data)
        while left:
            left = left[self.socket.send(left[: 2**18]) :]
            if reads:
                self.drain()

    def drain(self) -> None:
        """What has come is of no interest; the end is."""
        while select.select([self.socket], [], [], 0)[0]:
            if not self.socket.recv(2**18):
                raise ConnectionResetError


def repeat(port: int, data: bytes, reads: bool = True) -> None:
    """One guest's socket that is never at rest."""
    with Rude(port) as rude:
        while True:
            rude.flood(data, reads)


def many(port: int, number: int, data: Callable[[], Iterator[bytes]]) -> None:
    """So many sockets of one guest, each of which sends as much as is taken of it."""
    with contextlib.ExitStack() as stack:
        rudes: dict[Rude, Iterator[bytes]] = {}
        for _ in range(number):
            with contextlib.suppress(OSError):
                rudes[stack.enter_context(Rude(port))] = data()
        left = {rude: memoryview(b"") for rude in rudes}
        for rude in rudes:
            rude.socket.setblocking(False)
        while left:
            for rude in list(left):
                try:
                    rude.drain()
                    left[rude] = left[rude] or memoryview(next(rudes[rude]))
                    left[rude] = left[rude][rude.socket.send(left[rude]) :]
                except BlockingIOError:
                    time.sleep(0.0001)  # the pipe is full, which is what it is to be
                except OSError:
                    del left[rude]


def pings(port: int) -> None:
    repeat(port, frame(b"", PING) * 2**20)


def pongs(port: int) -> None:
    repeat(port, frame(b"", PONG) * 2**20)


def unread_pings(port: int) -> None:
    repeat(port, frame(bytes(125), PING) * 1000, reads=False)


def unread_refusals(port: int) -> None:
    repeat(port, text_of("nonsense", id="i" * 250) * 100, reads=False)


def empty_parts(port: int) -> None:
    with Rude(port) as rude:
        rude.flood(frame(b"", fin=False))
        while True:
            rude.flood(frame(b"", CONTINUATION, fin=False) * 2**18)


def short_parts(port: int) -> None:
    """Each message is within the limits."""
    parts = frame(b"x", fin=False) + frame(b"x", CONTINUATION, fin=False) * 900 + frame(b"x", CONTINUATION)
    repeat(port, parts * 100)


def subscriptions(port: int) -> None:
    """100 ids of 60 kB, each of which would be kept."""
    with Rude(port) as rude:
        for number in itertools.count():
            long = str(number % 100).ljust(60_000, "i")
            rude.flood(text_of("subscribe", topic="/game_status", id=long))


def latched(port: int) -> None:
    """40 sockets, each of which asks for the state of the battle again and again."""
    text = frame('{"op":"subscribe","topic":"/game_status"}')
    many(port, 40, lambda: itertools.cycle([text * 100]))


def long_json(port: int) -> None:
    """40 sockets of nearly 64 KiB each: many values, deep ones, and huge numbers."""
    texts = [
        b'{"op":"publish","topic":"/a","msg":{%s}}' % b",".join(b'"f%d":%d' % (n, n) for n in range(4500)),
        b'{"op":"publish","topic":"/a","msg":%s}' % (b"[" * 30_000 + b"]" * 30_000),
        b'{"op":"publish","topic":"/a","msg":{"data":%s}}' % (b"9" * 60_000),
        b'{"op":"publish","topic":"/a","msg":[%s]}' % b",".join([b"9" * 4000] * 15),
    ]
    many(port, 40, lambda: itertools.cycle([frame(text) for text in texts]))


def short_json(port: int) -> None:
    many(port, 40, lambda: itertools.cycle([text_of("publish", topic="/Robot0/command", msg={}) * 100]))


def pictures(port: int) -> None:
    """40 sockets of small pictures with long texts: 8 MiB, and 64 KiB."""
    texts = [f'{{"op":"publish","topic":"/a","msg":[{"[]," * number}[]]}}' for number in (2_700_000, 21_000)]
    pictures = [frame(encode(text, "png")) for text in texts]
    many(port, 40, lambda: itertools.cycle(pictures))


def sockets(port: int) -> None:
    """As many as one guest gets, and then more."""
    many(port, 100, lambda: itertools.cycle([frame(b"", PONG)]))


def comes_and_goes(port: int) -> None:
    with Rude(port):
        pass


def guesses(port: int) -> None:
    with Rude(port) as rude:
        for number in itertools.count():
            rude.flood(text_of("auth", client="operator", mac=f"guess {number}"))


def advertisements(port: int) -> None:
    """A signed-in player's, with changing `latch`."""
    topic = f"/Robot{VILLAIN}/command"
    with Rude(port, {"Cookie": f"laserbot_session={token(VILLAIN)}"}) as rude:
        for number in itertools.count():
            latch = number % 2 == 0
            rude.flood(text_of("advertise", topic=topic, type="laser_bot_battle/Robot_msg", latch=latch))
            rude.flood(text_of("unadvertise", topic=topic))


ATTACKS: dict[str, Callable[[int], None]] = {
    attack.__name__: attack
    for attack in (
        pings, pongs, unread_pings, unread_refusals, empty_parts, short_parts, subscriptions, latched, long_json,
        short_json, pictures, sockets, comes_and_goes, guesses, advertisements,
    )
}  # fmt: skip


def main() -> None:
    """Attackers have machines of their own: here they get what the others leave of this one."""
    attack, port = ATTACKS[sys.argv[1]], int(sys.argv[2])
    os.nice(19)
    print("attacking", flush=True)
    while True:
        with contextlib.suppress(OSError):
            attack(port)


if __name__ == "__main__":
    main()
