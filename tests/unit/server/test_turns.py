"""The web server's loop: whom it asks what he waits for, and whom it wakes."""

import socket
from collections.abc import Callable

from waitress import wasyncore

from server.web.turns import Turns


class Member(wasyncore.dispatcher):
    """Counts how often it is asked, and does `then` when it has been sent something."""

    def __init__(self, members: dict[int, wasyncore.dispatcher], then: Callable[[], None] = lambda: None) -> None:
        mine, self.peer = socket.socketpair()
        self.asked = self.written = 0
        self.reads, self.writes, self.rests = True, False, True
        self._then = then
        super().__init__(mine, map=members)

    def readable(self) -> bool:
        self.asked += 1
        return self.reads

    def writable(self) -> bool:
        return self.writes

    def handle_read(self) -> None:
        self.recv(1)
        self._then()

    def handle_write(self) -> None:
        self.written += 1
        self.writes = False

    def close(self) -> None:
        self.peer.close()
        super().close()


def turns(members: dict[int, wasyncore.dispatcher]) -> Turns:
    return Turns(members, lambda member: member.rests)


def test_a_silent_one_is_asked_once_whatever_others_do() -> None:
    members: dict[int, wasyncore.dispatcher] = {}
    silent = [Member(members) for _ in range(3)]
    left = list(range(10))

    def again() -> None:
        if left:
            left.pop()
            speaker.peer.send(b".")
        else:
            wasyncore.close_all(members)

    speaker = Member(members, again)
    speaker.peer.send(b".")
    turns(members).run(5)
    assert not left
    assert [member.asked for member in silent] == [1, 1, 1]


def test_one_that_a_worker_may_change_is_asked_at_each_turn_and_writes_when_it_wants_to() -> None:
    members: dict[int, wasyncore.dispatcher] = {}
    served = Member(members)
    served.rests = False

    def again() -> None:
        served.writes = True
        if served.written == 3:
            wasyncore.close_all(members)
        else:
            speaker.peer.send(b".")

    speaker = Member(members, again)
    speaker.peer.send(b".")
    turns(members).run(5)
    assert served.written == 3


def test_who_leaves_while_nobody_waits_for_him_is_heard_of_later() -> None:
    members: dict[int, wasyncore.dispatcher] = {}
    busy = Member(members)
    busy.rests = False
    stayed = []

    def again() -> None:
        stayed.append(busy in members.values())
        busy.reads = len(stayed) == 5
        if len(stayed) == 2:
            busy.peer.close()
        speaker.peer.send(b".")
        if not stayed[-1]:
            wasyncore.close_all(members)

    speaker = Member(members, again)
    speaker.peer.send(b".")
    turns(members).run(5)
    assert stayed[:5] == [True] * 5
    assert len(stayed) < 8


def test_one_that_is_stirred_is_asked_anew() -> None:
    members: dict[int, wasyncore.dispatcher] = {}
    late = Member(members)
    loop = turns(members)

    def closing() -> None:
        if late.written:
            wasyncore.close_all(members)
            return
        late.writes = True
        loop.stir(late.socket.fileno())
        speaker.peer.send(b".")

    speaker = Member(members, closing)
    speaker.peer.send(b".")
    loop.run(5)
    assert late.written == 1


def test_what_has_happened_to_one_who_is_gone_is_not_told_to_the_next_with_his_file() -> None:
    members: dict[int, wasyncore.dispatcher] = {}
    newcomers: list[Member] = []
    loop = turns(members)
    are_there = []

    def replace() -> None:
        if newcomers:
            are_there.append(newcomers[0] in members.values())
            wasyncore.close_all(members)
            return
        file = gone.socket.fileno()
        loop.leave(file)
        gone.close()
        newcomers.append(Member(members))
        assert newcomers[0].socket.fileno() == file
        loop.stir(file)
        speaker.peer.send(b".")

    speaker, gone = Member(members, replace), Member(members)
    for member in (speaker, gone):
        member.peer.send(b".")
    loop.run(5)
    assert are_there == [True]
