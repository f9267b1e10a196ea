"""The loop of a web server of waitress whose connections are silent most of the time: a silent one costs nothing.

waitress' own loop asks each connection at each turn what it waits for, and tells the kernel anew. Here the kernel keeps
what it was told, and only those are asked to whom something has happened.
"""

import select
from collections.abc import Callable, Mapping
from typing import Any

from waitress import wasyncore

_READ = select.EPOLLIN | select.EPOLLPRI


class Turns:
    """`members` are waitress' dispatchers by file, as they come and go; `rests` says whether one changes only when its
    peer does something. All but `stir` is for the loop's thread."""

    def __init__(self, members: Mapping[int, Any], rests: Callable[[Any], bool]) -> None:
        self._members = members
        self._rests = rests
        self._epoll = select.epoll()
        self._waits_for: dict[int, int] = {}  # events by file, as the kernel was told
        self._stirred: dict[int, None] = {}  # files to ask at the next turn, and until they rest

    def stir(self, file: int) -> None:
        """Its member may wait for something else from now on."""
        self._stirred[file] = None

    def leave(self, file: int) -> None:
        """Its member is about to close it."""
        self._stirred.pop(file, None)
        self._tell(file, 0)

    def run(self, timeout: float) -> None:
        """Until nobody is left; `timeout`: s that a turn may take in which nothing happens."""
        with self._epoll:
            for file in self._members:
                self.stir(file)
            while self._members:
                self._turn(timeout)

    def _turn(self, timeout: float) -> None:
        for file in list(self._stirred):
            self._ask(file)
        happened = [(file, self._members.get(file), events) for file, events in self._epoll.poll(timeout)]
        for file, member, events in happened:
            # one that was closed meanwhile may have left its file to another, which would take the blame
            if member is not None and self._members.get(file) is member:
                self.stir(file)
                wasyncore.readwrite(member, events)

    def _ask(self, file: int) -> None:
        member = self._members.get(file)
        if member is None:  # with its file, epoll forgets it
            del self._stirred[file]
            self._waits_for.pop(file, None)
            return
        rests = self._rests(member)  # before it is asked: what others change until then is in its answer
        events = _READ if member.readable() else 0
        if member.writable() and not member.accepting:
            events |= select.EPOLLOUT
        self._tell(file, events)
        if rests and events == _READ:
            self._stirred.pop(file, None)

    def _tell(self, file: int, events: int) -> None:
        before = self._waits_for.get(file, 0)
        if events == before:
            return
        if not events:  # else epoll would go on telling that the peer has left
            del self._waits_for[file]
            self._epoll.unregister(file)
        elif before:
            self._epoll.modify(file, events)
        else:
            self._epoll.register(file, events)
        if events:
            self._waits_for[file] = events
