from robot.transmit_queue import TransmitQueue


def test_an_empty_queue_has_nothing_to_write() -> None:
    queue = TransmitQueue(57600)
    assert queue.take(0.0) == b""
    assert queue.due is None


def test_of_commands_for_one_topic_only_the_newest_is_written() -> None:
    queue = TransmitQueue(57600)
    queue.command(100, b"old")
    queue.command(100, b"new")
    queue.command(101, b"other")
    assert queue.take(0.0) == b"new"
    assert queue.take(1.0) == b"other"
    assert queue.take(2.0) == b""


def test_protocol_bytes_keep_their_order_and_go_first() -> None:
    queue = TransmitQueue(57600)
    queue.command(100, b"command")
    queue.send(b"first ")
    queue.send(b"second")
    assert queue.take(0.0) == b"first second"
    assert queue.take(1.0) == b"command"


def test_nothing_is_written_while_the_line_is_still_busy_with_the_last_bytes() -> None:
    queue = TransmitQueue(57600)
    queue.command(100, bytes(576))  # 0.1 s at 57600 baud with start and stop bit
    assert queue.take(5.0) == bytes(576)
    queue.command(100, b"stale")
    assert queue.take(5.05) == b""
    queue.command(100, b"fresh")
    assert queue.due is not None
    assert abs(queue.due - 5.1) < 1e-6
    assert queue.take(5.11) == b"fresh"
