"""What waits for a subscriber that does not read."""

from tcpros.outgoing import MAX_WAITING, MAX_WAITING_BYTES, Backlog


def test_the_oldest_give_way_by_number() -> None:
    backlog = Backlog()
    backlog.add(str(number).encode() for number in range(MAX_WAITING + 10))
    assert backlog.all()[0] == b"10"
    assert len(backlog) == MAX_WAITING


def test_the_oldest_give_way_by_size_but_one_message_is_always_kept() -> None:
    backlog = Backlog()
    backlog.add([b"a" * 2**20] * 5)
    assert len(backlog) == 4
    backlog.add([b"b" * (MAX_WAITING_BYTES + 1)])
    assert backlog.all() == [b"b" * (MAX_WAITING_BYTES + 1)]
    backlog.add([b"c"])
    assert backlog.all() == [b"c"]


def test_what_is_put_back_comes_first_again() -> None:
    backlog = Backlog()
    backlog.add([b"1", b"2", b"3", b"4"])
    taken = backlog.take(3)
    assert taken == [b"1", b"2", b"3"]
    backlog.put_back(taken[1:])
    assert backlog.take(100) == [b"2", b"3", b"4"]
    assert not backlog


def test_what_is_put_back_gives_way_first() -> None:
    backlog = Backlog()
    backlog.add([b"new"] * MAX_WAITING)
    backlog.put_back([b"old"])
    assert b"old" not in backlog.all()
