import struct

import pytest

from robot.rosserial.announcements import MAX_TOPICS
from robot.rosserial.events import (
    DeviceCalls,
    DeviceLog,
    DevicePublishes,
    DeviceServes,
    DeviceSubscribes,
    Event,
    Lost,
    Message,
    Notice,
    ParameterRequest,
    Send,
    ServiceInfo,
)
from robot.rosserial.frame import encode
from robot.rosserial.host import ANSWER_TIMEOUT, Host
from robot.rosserial.topic_info import TopicInfo

COMMAND = TopicInfo(100, "command", "laser_bot_battle/Robot_msg", "aa81278360e1bdd1ffce0a4efe0ae199", 280)
RESPONSE = TopicInfo(125, "response", "std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e", 280)
BOARD = TopicInfo(127, "board", "laser_bot_battle/BoardHealth", "ce93022442a8a38cf094bba3a502a1a1", 280)
SCAN = TopicInfo(130, "scan", "sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369", 16_384)
TOPICS = encode(0, RESPONSE.encode()) + encode(1, COMMAND.encode())
HIT = bytes.fromhex("ff fe 00 00 ff 7d 00 82")
TIME_REQUEST = encode(10, bytes(8))
ASK = Send(bytes.fromhex("ff fe 00 00 ff 00 00 ff"))
WALL = 1_700_000_000.25  # s since 1970


class Conversation:
    """One that has begun at time 0, and its clock."""

    def __init__(self) -> None:
        self.host = Host(0.0)
        self.now = 0.0

    def hear(self, data: bytes) -> list[Event]:
        return self.host.receive(data, self.now, WALL)

    def wait(self, seconds: float) -> list[Event]:
        """What happens in that time, looked at ten times a second."""
        events = []
        for _ in range(round(seconds * 10)):
            self.now = round(self.now + 0.1, 1)
            events += self.host.tick(self.now, WALL)
        return events


def test_garbage_is_told_at_most_once_in_ten_seconds() -> None:
    talk = Conversation()
    told = []
    for _ in range(25):
        told += [event for event in talk.hear(b"garbage") if isinstance(event, Notice)]
        talk.wait(1.0)
    assert told == [
        Notice(f"noise on the serial line so far (0 broken frames, {n} stray bytes: wrong speed or sketch?)")
        for n in (7, 77, 147)
    ]


@pytest.fixture
def fresh() -> Conversation:
    return Conversation()


@pytest.fixture
def sketch() -> Conversation:
    """With any sketch."""
    conversation = Conversation()
    conversation.host.tick(0.0, WALL)
    conversation.hear(TOPICS)
    return conversation


@pytest.fixture
def joined(sketch: Conversation) -> Conversation:
    """With our own firmware."""
    sketch.hear(encode(0, BOARD.encode()))
    return sketch


def test_topics_are_asked_for_at_once_and_each_second_until_there_is_an_answer(fresh: Conversation) -> None:
    assert fresh.host.tick(0.0, WALL) == [ASK]
    assert fresh.wait(3.5) == [ASK] * 3
    assert not fresh.host.answered
    fresh.hear(TOPICS)
    assert fresh.host.answered
    assert fresh.wait(2.9) == []


def test_the_topics_of_the_device_are_told(fresh: Conversation) -> None:
    assert fresh.hear(TOPICS) == [DevicePublishes(RESPONSE), DeviceSubscribes(COMMAND)]


def test_a_device_that_never_answers_is_lost(fresh: Conversation) -> None:
    *asked, lost = fresh.wait(ANSWER_TIMEOUT)
    nothing = " (nothing came at all: no sketch, another port, or one that is still starting?)"
    late = Notice(f"no answer to the topic request for 8 s{nothing}: waiting for 15 s")
    assert [event for event in asked if event != ASK] == [late]
    assert asked.index(late) == 8, "it was told after as many questions, and seconds"
    assert lost == Lost(f"no answer to the topic request within 15 s{nothing}")


def test_what_a_device_sends_that_does_not_tell_its_topics_is_named(fresh: Conversation) -> None:
    for _ in range(int(ANSWER_TIMEOUT)):
        fresh.hear(HIT)
        *_, last = fresh.wait(1)
    assert isinstance(last, Lost)
    assert "15 other frames came, as from a sketch that does not tell its topics" in last.reason


def test_a_device_that_sends_only_garbage_is_lost_and_the_garbage_is_named(fresh: Conversation) -> None:
    for _ in range(int(ANSWER_TIMEOUT) * 10 - 1):
        fresh.hear(b"\x00\x80" + HIT[:-1] + b"\x00")
        fresh.wait(0.1)
    lost = fresh.wait(0.1)[-1]
    assert isinstance(lost, Lost)
    assert "149 broken frames" in lost.reason
    assert "stray bytes" in lost.reason


def test_a_hit_is_a_message(joined: Conversation) -> None:
    assert joined.hear(HIT) == [Message(125, b"")]


def test_a_request_for_the_time_is_answered_with_seconds_and_nanoseconds(joined: Conversation) -> None:
    [answer] = joined.hear(TIME_REQUEST)
    assert answer == Send(encode(10, struct.pack("<II", 1_700_000_000, 250_000_000)))


def test_the_time_alone_does_not_make_a_device_ready(fresh: Conversation) -> None:
    assert len(fresh.hear(TIME_REQUEST)) == 1
    assert not fresh.host.answered


def test_requests_for_the_time_keep_the_connection_for_ever(joined: Conversation) -> None:
    for _ in range(20):
        assert joined.wait(2.9) == []
        joined.hear(TIME_REQUEST)


def test_topics_are_asked_for_again_after_3_s_without_a_request_for_the_time(joined: Conversation) -> None:
    assert joined.wait(2.9) == []
    assert joined.wait(0.2) == [ASK]
    assert joined.hear(TOPICS) == [DevicePublishes(RESPONSE), DeviceSubscribes(COMMAND)]
    assert joined.wait(2.9) == []


def test_a_device_that_never_asks_for_the_time_but_tells_its_topics_stays(joined: Conversation) -> None:
    for _ in range(20):
        asked = joined.wait(4)
        assert set(asked) == {ASK}
        joined.hear(TOPICS)


def test_our_firmware_is_lost_after_5_s_of_silence(joined: Conversation) -> None:
    *asked, lost = joined.wait(5)
    assert asked == [ASK] * 4
    assert isinstance(lost, Lost)
    assert "no time request for 5 s" in lost.reason


def test_any_other_sketch_may_be_silent_for_15_s(sketch: Conversation) -> None:
    asked = sketch.wait(14.9)
    assert asked == [ASK] * 6, "that many fit into the 64 bytes of an Uno"
    sketch.hear(TIME_REQUEST)
    *_, lost = sketch.wait(15.1)
    assert lost == Lost("no sign of life for 15 s and no answer to the topic request")


@pytest.mark.parametrize(
    "frame",
    [HIT, TIME_REQUEST, encode(7, b"\x02\x07\0\0\0low bat"), encode(6, b"\x04\0\0\0gain"), encode(101), encode(42)],
)
def test_any_good_frame_of_a_sketch_is_a_sign_of_life(sketch: Conversation, frame: bytes) -> None:
    for _ in range(4):
        sketch.wait(14.9)
        sketch.hear(frame)
    assert not [event for event in sketch.wait(2.9) if event == ASK]


def test_noise_is_none(sketch: Conversation) -> None:
    for _ in range(14):
        sketch.hear(b"noise" + HIT[:-1] + b"?")
        sketch.wait(1)
    assert isinstance(sketch.wait(1)[-1], Lost)


def test_a_device_with_large_buffers_may_be_silent_for_as_long_as_a_frame_takes() -> None:
    host = Host(0.0, byte_time=10 / 57600)
    host.receive(TOPICS + encode(0, SCAN.encode()), 0.0, WALL)
    lost = next(now for now in range(1000) if any(isinstance(event, Lost) for event in host.tick(now / 10, WALL)))
    assert lost / 10 == pytest.approx(15 + 16_384 / 5760, abs=0.1)


def test_a_host_that_was_away_does_not_take_that_for_silence_of_the_device(joined: Conversation) -> None:
    joined.wait(2)
    joined.now += 60
    assert joined.wait(0.5) == []
    assert isinstance(joined.wait(3)[-1], Lost)


def test_messages_alone_do_not_keep_the_connection_with_our_firmware(joined: Conversation) -> None:
    for _ in range(4):
        joined.hear(HIT)
        joined.wait(1)
    assert isinstance(joined.wait(1.1)[-1], Lost)


def test_a_message_on_an_unknown_topic_makes_the_topics_be_asked_for_again_but_not_all_the_time(
    joined: Conversation,
) -> None:
    joined.wait(1.5)
    stranger = encode(101, b"x")
    notice, ask = joined.hear(stranger)
    assert isinstance(notice, Notice)
    assert ask == ASK
    assert joined.hear(stranger * 10) == []
    joined.wait(1.1)
    assert joined.hear(stranger)[-1] == ASK


def test_a_subscribed_topic_is_no_topic_to_publish_on(joined: Conversation) -> None:
    joined.wait(2)
    assert isinstance(joined.hear(encode(100, b"\1\0\0"))[0], Notice)


def test_a_log_line_of_the_sketch_is_told(joined: Conversation) -> None:
    assert joined.hear(encode(7, b"\x02\x07\0\0\0low bat")) == [DeviceLog(2, "low bat")]


def test_a_request_for_a_parameter_is_told(joined: Conversation) -> None:
    assert joined.hear(encode(6, b"\x04\0\0\0gain")) == [ParameterRequest("gain")]


def test_frames_may_be_as_long_as_the_buffers_of_which_the_device_has_told(joined: Conversation) -> None:
    *_, scan = joined.hear(encode(0, SCAN.encode()) + encode(130, bytes(16_384)))
    assert scan == Message(130, bytes(16_384))


def test_a_longer_one_is_told_as_that_and_not_as_noise_once_in_ten_seconds(joined: Conversation) -> None:
    joined.hear(encode(0, SCAN.encode()))
    longer = encode(130, bytes(16_385))
    told = [event for _ in range(25) for event in joined.hear(longer + TIME_REQUEST) + joined.wait(1)]
    notices = [event.text for event in told if isinstance(event, Notice)]
    assert len(notices) == 3
    assert notices[1] == (
        "dropped a frame of 16385 bytes from the device (11 so far): its limit is 16384 bytes; "
        "enlarge the buffers in its sketch"
    )
    assert all(isinstance(event, Send | Notice) for event in told)


def test_a_buffer_beyond_what_a_frame_can_hold_is_no_reason_to_refuse_the_topic(joined: Conversation) -> None:
    endless = TopicInfo(131, "endless", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", 2**31 - 1)
    assert joined.hear(encode(0, endless.encode())) == [DevicePublishes(endless)]
    assert joined.hear(encode(131, bytes(65_535))) == [Message(131, bytes(65_535))]


REQUEST, ANSWER = "d41d8cd98f00b204e9800998ecf8427e", "937c9679a518e3a18d831e57125ea522"  # md5s of std_srvs/Trigger


def half(topic_id: int, md5: str, size: int = 280) -> bytes:
    return TopicInfo(topic_id, "fire", "std_srvs/Trigger", md5, size).encode()


def test_a_service_is_told_once_both_of_its_halves_are_there(joined: Conversation) -> None:
    assert joined.hear(encode(2, half(126, ANSWER))) == []
    service = ServiceInfo("fire", "std_srvs/Trigger", 101, REQUEST, 126, ANSWER, 300)
    assert joined.hear(encode(3, half(101, REQUEST, 300))) == [DeviceServes(service)]
    assert joined.hear(encode(126, b"answer")) == [Message(126, b"answer")]
    joined.wait(2)
    assert isinstance(joined.hear(encode(101, b"?"))[0], Notice)


def test_a_service_that_the_device_calls_is_told_likewise(joined: Conversation) -> None:
    assert joined.hear(encode(5, half(102, ANSWER, 300))) == []
    service = ServiceInfo("fire", "std_srvs/Trigger", 127, REQUEST, 102, ANSWER, 300)
    assert joined.hear(encode(4, half(127, REQUEST))) == [DeviceCalls(service)]
    assert joined.hear(encode(127, b"request")) == [Message(127, b"request")]


def test_a_device_that_tells_too_many_topics_is_refused_at_once(joined: Conversation) -> None:
    many = [encode(0, TopicInfo(200 + i, f"t{i}", "std_msgs/Empty", "", 280).encode()) for i in range(10_000)]
    told = joined.hear(b"".join(many[: MAX_TOPICS - 3]))
    assert len(told) == MAX_TOPICS - 3
    lost = joined.hear(many[MAX_TOPICS - 3])
    assert lost == [Lost(f"the device tells more than {MAX_TOPICS} topics")]


def test_telling_the_same_again_is_no_new_topic(joined: Conversation) -> None:
    for _ in range(MAX_TOPICS):
        assert len(joined.hear(TOPICS)) == 2


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        (encode(0, b"\x64"), "broken topic info"),
        (encode(1, TopicInfo(7, "evil", "a/B", "", 1).encode()), "reserved id 7"),
        (encode(7, b""), "broken log message"),
        (encode(7, b"\x01\xff\0\0\0short"), "broken log message"),
        (encode(2, b"service"), "broken topic info"),
        (encode(1, TopicInfo(101, "none", "a/B", "", 0).encode()), "with a buffer of 0 bytes refused"),
        (encode(0, TopicInfo(126, "less", "a/B", "", -1).encode()), "with a buffer of -1 bytes refused"),
        (encode(42, b"?"), "unknown id 42"),
    ],
)
def test_what_cannot_be_used_is_told_and_changes_nothing(joined: Conversation, frame: bytes, words: str) -> None:
    [notice] = joined.hear(frame)
    assert isinstance(notice, Notice)
    assert words in notice.text
    assert joined.hear(HIT) == [Message(125, b"")]


def test_a_half_frame_does_not_hold_back_the_hit_behind_it_for_ever(joined: Conversation) -> None:
    assert joined.hear(b"\xff\xfe\x64\x00\x9b" + HIT) == []
    assert joined.wait(2) == [Message(125, b"")]
