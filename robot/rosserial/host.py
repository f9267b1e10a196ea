"""The host's side of one conversation with a device, as a state machine: bytes and the time in, events out.

The host asks for topics until the device tells them, answers its requests for the time, asks again when these stay
away, and gives the device up when that brings no answer either.
"""

import struct
from dataclasses import dataclass

from robot.rosserial.frame import Decoder, Frame, encode
from robot.rosserial.topic_info import TopicInfo

# topic ids of the protocol itself
PUBLISHER = 0  # device -> host: TopicInfo; host -> device, empty: tell me your topics
SUBSCRIBER = 1
SERVICES = range(2, 6)
PARAMETER = 6
LOG = 7
TIME = 10
TX_STOP = 11
FIRST_TOPIC = 100  # ids of messages

TOPIC_REQUEST = encode(PUBLISHER)
STOP_SENDING = encode(TX_STOP)
NO_PARAMETER = encode(PARAMETER, bytes(12))  # no integers, no floats, no strings

ASK_PERIOD = 1.0  # s between topic requests: the first ones may meet a boot loader
NOISE_PERIOD = 10.0  # s between two complaints about broken frames
ANSWER_TIMEOUT = 8.0  # s to the first answer; a board that resets on opening boots for 2 to 4 s
SILENCE = 15.0  # s without a time request until topics are asked for again (devices ask every 2.5 to 5 s)
SILENCE_AFTER_ASKING = 5.0  # s more until the device is given up


@dataclass(frozen=True)
class Send:
    """Bytes for the device."""

    data: bytes


@dataclass(frozen=True)
class DevicePublishes:
    info: TopicInfo


@dataclass(frozen=True)
class DeviceSubscribes:
    info: TopicInfo


@dataclass(frozen=True)
class Message:
    """A serialised ROS message on one of the topics that the device publishes."""

    topic_id: int
    payload: bytes


@dataclass(frozen=True)
class DeviceLog:
    """A log line of the sketch; level 0 debug, 1 info, 2 warning, 3 error, 4 fatal."""

    level: int
    text: str


@dataclass(frozen=True)
class Notice:
    """Something wrong that is worth a log line but changes nothing."""

    text: str


@dataclass(frozen=True)
class Lost:
    """The device does not answer any more; the conversation has ended."""

    reason: str


Event = Send | DevicePublishes | DeviceSubscribes | Message | DeviceLog | Notice | Lost


class Host:
    """All times are s of one steady clock, but `wall`, which is s since 1970."""

    def __init__(self, now: float) -> None:
        self._decoder = Decoder()
        self._started = now
        self._asked: float | None = None
        self._last_sign: float | None = None  # of a living device: topic info or time request
        self._published: set[int] = set()
        self._noise_told: tuple[float, str] = (now - NOISE_PERIOD, "")

    @property
    def answered(self) -> bool:
        """Whether the device has told a topic of its own: it speaks the protocol and is ready."""
        return self._last_sign is not None

    def receive(self, data: bytes, now: float, wall: float) -> list[Event]:
        """What follows from bytes of the device."""
        return self._handle(self._decoder.feed(data, now), now, wall) + self._complaint(now)

    def tick(self, now: float, wall: float) -> list[Event]:
        """What follows from the time alone; to be called at least twice a second."""
        events = self._handle(self._decoder.expire(now), now, wall)
        if self._last_sign is None:
            if now - self._started >= ANSWER_TIMEOUT:
                return [*events, Lost(f"no answer to the topic request within {ANSWER_TIMEOUT:g} s{self._noise()}")]
            return events + self._ask(now)
        silent = now - self._last_sign
        if silent >= SILENCE + SILENCE_AFTER_ASKING:
            reason = f"no time request for {silent:.0f} s and no answer to the topic request{self._noise()}"
            return [*events, Lost(reason)]
        return events + (self._ask(now) if silent >= SILENCE else [])

    def _complaint(self, now: float) -> list[Event]:
        """A line about what was not understood, when that has grown, at most one per NOISE_PERIOD."""
        told_at, told = self._noise_told
        noise = self._noise()
        if noise == told or now - told_at < NOISE_PERIOD:
            return []
        self._noise_told = (now, noise)
        return [Notice(f"noise on the serial line so far{noise}")]

    def _noise(self) -> str:
        bad, garbage = self._decoder.bad_frames, self._decoder.garbage
        return f" ({bad} broken frames, {garbage} stray bytes: wrong speed or sketch?)" if bad or garbage else ""

    def _ask(self, now: float) -> list[Event]:
        if self._asked is not None and now - self._asked < ASK_PERIOD:
            return []
        self._asked = now
        return [Send(TOPIC_REQUEST)]

    def _handle(self, frames: list[Frame], now: float, wall: float) -> list[Event]:
        return [event for frame in frames for event in self._handle_frame(frame, now, wall)]

    def _handle_frame(self, frame: Frame, now: float, wall: float) -> list[Event]:
        if frame.topic_id >= FIRST_TOPIC:
            return self._message(frame, now)
        if frame.topic_id in (PUBLISHER, SUBSCRIBER):
            return self._topic(frame, now)
        if frame.topic_id == TIME:
            return self._time(now, wall)
        return _aside(frame)

    def _topic(self, frame: Frame, now: float) -> list[Event]:
        try:
            info = TopicInfo.decode(frame.payload)
        except ValueError as error:
            return [Notice(str(error))]
        if info.topic_id < FIRST_TOPIC:
            return [Notice(f"topic {info.topic_name!r} with the reserved id {info.topic_id} ignored")]
        self._last_sign = now
        if frame.topic_id == SUBSCRIBER:
            return [DeviceSubscribes(info)]
        self._published.add(info.topic_id)
        return [DevicePublishes(info)]

    def _message(self, frame: Frame, now: float) -> list[Event]:
        if frame.topic_id in self._published:
            return [Message(frame.topic_id, frame.payload)]
        # a device that still counts on an earlier conversation, or whose topic info got lost
        asking = self._ask(now)
        notice = Notice(f"message on unknown topic id {frame.topic_id}: asking for the topics again")
        return [notice, *asking] if asking else []

    def _time(self, now: float, wall: float) -> list[Event]:
        if self._last_sign is not None:  # else: from an earlier conversation, the topics are still to come
            self._last_sign = now
        secs, fraction = divmod(wall, 1)
        return [Send(encode(TIME, struct.pack("<II", int(secs), int(fraction * 1e9))))]


def _aside(frame: Frame) -> list[Event]:
    """Frames that do not touch the conversation."""
    if frame.topic_id == LOG:
        return [_log(frame.payload)]
    if frame.topic_id == PARAMETER:
        # the answer "nothing" spares the sketch its time-out
        name = frame.payload[4:].decode(errors="replace")
        return [Send(NO_PARAMETER), Notice(f"the device asks for parameter {name!r}: it gets none")]
    if frame.topic_id in SERVICES:
        return [Notice("the device offers or wants a ROS service: not supported, ignored")]
    return [Notice(f"frame with unknown id {frame.topic_id} ignored")]


def _log(payload: bytes) -> DeviceLog | Notice:
    """rosserial_msgs/Log: u8 level, string."""
    if len(payload) < 5 or len(payload) != 5 + int.from_bytes(payload[1:5], "little"):
        return Notice(f"broken log message of {len(payload)} bytes ignored")
    return DeviceLog(payload[0], payload[5:].decode(errors="replace"))
