from robot.serial.transmit_queue import BROKEN_OFF, MAX_ANSWERS, PIECE, TransmitQueue


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


def test_frames_of_the_protocol_keep_their_order() -> None:
    queue = TransmitQueue(57600)
    queue.send(b"first")
    queue.send(b"second")
    assert queue.take(0.0) == b"first"
    assert queue.take(1.0) == b"second"


def test_a_command_waits_for_one_frame_of_the_protocol_at_most_and_the_other_way_round() -> None:
    queue = TransmitQueue(57600)
    taken = []
    for number in range(6):
        queue.send(b"answer")
        queue.command(100, b"command")
        taken.append(queue.take(float(number)))
    assert taken == [b"command", b"answer"] * 3


def test_answers_do_not_pile_up() -> None:
    queue = TransmitQueue(57600)
    for _ in range(1000):
        queue.send(bytes(20))
    waiting = 0
    while queue.due is not None:
        waiting += len(queue.take(queue.due))
    assert 0 < waiting <= MAX_ANSWERS
    assert queue.refused == 1000 - waiting // 20


def test_a_frame_that_is_longer_than_the_room_goes_if_nothing_else_waits() -> None:
    queue = TransmitQueue(57600)
    queue.send(bytes(MAX_ANSWERS + 1))
    assert queue.take(0.0) == bytes(MAX_ANSWERS + 1)


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


def test_a_long_frame_goes_in_pieces_at_the_lines_speed_and_nothing_comes_between_them() -> None:
    queue = TransmitQueue(57600)
    frame = bytes(range(256)) * 25
    queue.command(100, frame)
    queue.command(101, b"behind it")
    written, now = [], 0.0
    while queue.due is not None:
        now = queue.due
        written.append(queue.take(now))
    assert b"".join(written) == frame + b"behind it"
    assert {len(piece) for piece in written[:-2]} == {PIECE}
    assert abs(now - len(frame) / 5760) < 1e-6


def test_a_long_answer_has_room_beside_short_ones_but_not_beside_another_one() -> None:
    queue = TransmitQueue(57600)
    for frame in (b"short", bytes(16_000), b"short", bytes(16_000)):
        queue.send(frame)
    assert queue.refused == 1
    written = b""
    while queue.due is not None:
        written += queue.take(queue.due)
    assert written == b"short" + bytes(16_000) + b"short"
    queue.send(bytes(16_000))
    assert queue.refused == 1


def test_what_is_urgent_breaks_off_a_long_frame_and_goes_once_the_device_has_given_that_up() -> None:
    queue = TransmitQueue(57600)
    assert queue.break_off(0.0) == 0
    queue.command(101, bytes(16_000))
    queue.take(0.0)
    queue.send(b"answer")
    queue.command(100, b"neutral")
    silent = PIECE / 5760 + BROKEN_OFF
    assert abs(queue.break_off(0.0) - silent) < 1e-6
    assert queue.take(silent - 0.001) == b""
    assert queue.take(silent) == b"neutral"
    assert queue.take(1.0) == b"answer"
    assert queue.take(2.0) == b""
