from robot.outbox import Outbox


def test_an_empty_outbox_has_nothing_to_write() -> None:
    outbox = Outbox(57600)
    assert outbox.take(0.0) == b""
    assert outbox.due is None


def test_of_commands_for_one_topic_only_the_newest_is_written() -> None:
    outbox = Outbox(57600)
    outbox.command(100, b"old")
    outbox.command(100, b"new")
    outbox.command(101, b"other")
    assert outbox.take(0.0) == b"new"
    assert outbox.take(1.0) == b"other"
    assert outbox.take(2.0) == b""


def test_protocol_bytes_keep_their_order_and_go_first() -> None:
    outbox = Outbox(57600)
    outbox.command(100, b"command")
    outbox.send(b"first ")
    outbox.send(b"second")
    assert outbox.take(0.0) == b"first second"
    assert outbox.take(1.0) == b"command"


def test_nothing_is_written_while_the_line_is_still_busy_with_the_last_bytes() -> None:
    outbox = Outbox(57600)
    outbox.command(100, bytes(576))  # 0.1 s at 57600 baud with start and stop bit
    assert outbox.take(5.0) == bytes(576)
    outbox.command(100, b"stale")
    assert outbox.take(5.05) == b""
    outbox.command(100, b"fresh")
    assert outbox.due is not None
    assert abs(outbox.due - 5.1) < 1e-6
    assert outbox.take(5.11) == b"fresh"
