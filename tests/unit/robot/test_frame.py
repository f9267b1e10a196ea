import pytest

from robot.rosserial.frame import HALF_FRAME_TIMEOUT, Decoder, Frame, encode

# the samples of the original system's wire
VECTORS = {
    "forward": ("ff fe 03 00 fc 64 00 01 00 00 9a", Frame(100, b"\x01\x00\x00")),
    "back, left, shoot": ("ff fe 03 00 fc 64 00 ff ff 01 9c", Frame(100, b"\xff\xff\x01")),
    "hit": ("ff fe 00 00 ff 7d 00 82", Frame(125, b"")),
    "topic request": ("ff fe 00 00 ff 00 00 ff", Frame(0, b"")),
}
FORWARD = bytes.fromhex(VECTORS["forward"][0])
HIT = bytes.fromhex(VECTORS["hit"][0])


@pytest.mark.parametrize(("wire", "frame"), VECTORS.values(), ids=VECTORS.keys())
def test_the_bytes_are_those_of_the_protocol(wire: str, frame: Frame) -> None:
    assert encode(frame.topic_id, frame.payload) == bytes.fromhex(wire)


@pytest.mark.parametrize(("wire", "frame"), VECTORS.values(), ids=VECTORS.keys())
def test_the_bytes_of_the_protocol_are_understood(wire: str, frame: Frame) -> None:
    assert Decoder().feed(bytes.fromhex(wire), 0.0) == [frame]


def test_a_long_frame_survives_both_ways() -> None:
    payload = bytes(range(256)) + b"\xff\xfe" * 20
    assert Decoder().feed(encode(300, payload), 0.0) == [Frame(300, payload)]


@pytest.mark.parametrize(("topic_id", "payload"), [(-1, b""), (0x10000, b""), (100, bytes(0x10000))])
def test_what_does_not_fit_into_a_frame_is_refused(topic_id: int, payload: bytes) -> None:
    with pytest.raises(ValueError, match="no frame"):
        encode(topic_id, payload)


@pytest.mark.parametrize("position", range(len(FORWARD + HIT) + 1))
def test_frames_may_come_in_two_pieces_split_anywhere(position: int) -> None:
    decoder = Decoder()
    wire = FORWARD + HIT
    frames = decoder.feed(wire[:position], 0.0) + decoder.feed(wire[position:], 0.1)
    assert frames == [VECTORS["forward"][1], VECTORS["hit"][1]]
    assert (decoder.bad_frames, decoder.garbage) == (0, 0)


def test_frames_may_come_byte_by_byte() -> None:
    decoder = Decoder()
    frames = [frame for number in range(len(FORWARD)) for frame in decoder.feed(FORWARD[number : number + 1], 0.0)]
    assert frames == [VECTORS["forward"][1]]


@pytest.mark.parametrize("garbage", [b"hello", b"\xff", b"\xff\xff\xff", b"\xfe\xff", bytes(100), b"\x00\xff\x01"])
def test_garbage_before_and_between_frames_is_skipped_and_counted(garbage: bytes) -> None:
    decoder = Decoder()
    assert decoder.feed(garbage + HIT + garbage + HIT, 0.0) == [VECTORS["hit"][1]] * 2
    assert decoder.garbage == 2 * len(garbage)
    assert decoder.bad_frames == 0


@pytest.mark.parametrize("position", range(len(FORWARD)))
def test_a_frame_with_a_damaged_byte_is_dropped_and_the_next_one_is_found(position: int) -> None:
    damaged = bytearray(FORWARD)
    damaged[position] ^= 0x10
    decoder = Decoder()
    assert decoder.feed(bytes(damaged) + HIT, 0.0) == [VECTORS["hit"][1]]
    assert decoder.bad_frames + decoder.garbage > 0


@pytest.mark.parametrize("position", range(len(FORWARD)))
def test_a_lost_byte_costs_only_its_own_frame(position: int) -> None:
    decoder = Decoder()
    wire = FORWARD[:position] + FORWARD[position + 1 :] + HIT + HIT
    assert decoder.feed(wire, 0.0) == [VECTORS["hit"][1]] * 2


def test_a_damaged_length_does_not_swallow_what_follows() -> None:
    decoder = Decoder()
    announced = b"\xff\xfe\x10\x27\xc8"  # 10000 bytes, with the right checksum
    assert decoder.feed(announced + HIT, 0.0) == [VECTORS["hit"][1]]
    assert decoder.bad_frames == 1


def test_a_half_frame_is_given_up_after_a_while_and_the_frames_in_it_are_found() -> None:
    decoder = Decoder()
    announced = b"\xff\xfe\x64\x00\x9b"  # 100 bytes to come
    assert decoder.feed(announced + HIT, 5.0) == []
    assert decoder.expire(5.0 + HALF_FRAME_TIMEOUT * 0.9) == []
    assert decoder.expire(5.0 + HALF_FRAME_TIMEOUT * 1.1) == [VECTORS["hit"][1]]
    assert decoder.bad_frames == 1
    assert decoder.expire(100.0) == []


def test_a_slow_frame_is_not_given_up_because_of_older_ones() -> None:
    decoder = Decoder()
    decoder.feed(HIT[:4], 0.0)
    assert decoder.feed(HIT[4:] + HIT[:4], 0.9) == [VECTORS["hit"][1]]
    assert decoder.expire(1.5) == []
    assert decoder.feed(HIT[4:], 1.6) == [VECTORS["hit"][1]]


def test_frames_of_any_length_are_found_once_the_device_has_buffers_for_them() -> None:
    payload = bytes(range(255)) * 257
    decoder = Decoder()
    decoder.longest = len(payload)
    wire = encode(200, payload) + HIT
    frames = [frame for at in range(0, len(wire), 4096) for frame in decoder.feed(wire[at : at + 4096], 0.0)]
    assert frames == [Frame(200, payload), VECTORS["hit"][1]]
    assert (decoder.bad_frames, decoder.garbage) == (0, 0)


def test_a_frame_may_say_that_those_behind_it_are_longer() -> None:
    decoder = Decoder()
    found = []
    for frame in decoder.frames(HIT + encode(200, bytes(5000)), 0.0):
        decoder.longest = 5000
        found.append(frame.topic_id)
    assert found == [125, 200]


def test_a_frame_that_is_too_long_is_no_noise_and_hides_nothing() -> None:
    decoder = Decoder()
    wire = encode(200, b"\xff\xfe\x00garbage\xff\xfe\x10\x27\xc8" * 500) + b"stray" + HIT
    frames = [frame for at in range(0, len(wire), 1000) for frame in decoder.feed(wire[at : at + 1000], 0.0)]
    assert frames == [VECTORS["hit"][1]]
    assert (decoder.bad_frames, decoder.too_long, decoder.last_too_long) == (1, 1, 7500)
    assert decoder.garbage == len(b"stray")


def test_the_rest_of_a_long_frame_is_waited_for_as_long_as_it_takes_on_the_line() -> None:
    decoder = Decoder(byte_time=10 / 57600)
    decoder.longest = 16_384
    wire = encode(200, bytes(16_384))
    decoder.feed(wire[:100], 0.0)
    assert decoder.expire(3.8) == []
    assert decoder.feed(wire[100:], 3.8) == [Frame(200, bytes(16_384))]
    decoder.feed(wire[:100], 4.0)
    decoder.expire(8.0)
    assert decoder.bad_frames == 1
