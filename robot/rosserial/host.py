"""The host's side of one conversation with a device, as a state machine: bytes and the time in, events out.

The host asks for topics until the device tells them, answers its requests for the time, asks again when the device
falls silent, and gives it up when that brings no answer either. Every good frame is a sign of life; from our own
firmware, which sends its health as long as it runs, only what shows that it hears the host, too.
"""

import struct
from collections.abc import Iterable

from robot.rosserial import ids
from robot.rosserial.announcements import KINDS, Announcements, TooManyTopicsError
from robot.rosserial.events import DeviceLog, Event, Lost, Message, Notice, ParameterRequest, Send
from robot.rosserial.frame import MAX_PAYLOAD, Decoder, Frame, encode

ASK_PERIOD = 1.0  # s between topic requests: the first ones may meet a boot loader
NOISE_PERIOD = 10.0  # s between two complaints about broken frames
ANSWER_TIMEOUT = 15.0  # s to the first answer, as with rosserial_python: a sketch may have much to do before it listens
ANSWER_EXPECTED = 8.0  # s; a board that resets on opening boots for 2 to 4 s. That it takes longer is told.
SILENCE = 3.0  # s without a sign of life until topics are asked for again: devices, ros_lib too, speak every 2.5 s
# Our firmware is never busy for long, so that a fault of it is noticed soon:
SILENCE_ASK_PERIOD = 0.5  # s; a board that has reset itself boots for up to 2 s, and must hear one
SILENCE_AFTER_ASKING = 2.0  # s more until the device is given up
# Other sketches may be, and all the questions then wait in the 64 bytes of an Uno:
SKETCH_ASK_PERIOD = 2.0  # s
SKETCH_SILENCE = 15.0  # s in all until the device is given up, as with rosserial_python
AWAY = 1.0  # s; a host that did not look for longer cannot say that the device was silent


class Host:
    """All times are s of one steady clock, but `wall`, which is s since 1970."""

    def __init__(self, now: float, byte_time: float = 0.0, answer_within: float = ANSWER_TIMEOUT) -> None:
        """`byte_time`: s that a byte takes on the line; `answer_within`: s to the first answer."""
        self._decoder = Decoder(byte_time)
        self._byte_time = byte_time
        self._answer_within = answer_within
        self._answer_is_late = False
        self._others = 0  # frames before the answer
        self._started = self._looked = now
        self._asked: float | None = None
        self._last_sign: float | None = None
        self._announcements = Announcements()
        self._noise_told: tuple[float, str] = (now - NOISE_PERIOD, "")
        self._too_long_told: tuple[float, int] = (now - NOISE_PERIOD, 0)

    @property
    def answered(self) -> bool:
        """Whether the device has told a topic of its own: it speaks the protocol and is ready."""
        return self._last_sign is not None

    @property
    def broken_frames(self) -> int:
        return self._decoder.bad_frames

    @property
    def stray_bytes(self) -> int:
        return self._decoder.garbage

    def silence(self, now: float) -> float | None:
        """s since the device's last sign of life; None while there was none."""
        return None if self._last_sign is None else now - self._last_sign

    def receive(self, data: bytes, now: float, wall: float) -> list[Event]:
        """What follows from bytes of the device."""
        events = self._handle(self._decoder.frames(data, now), now, wall)
        return events + self._complaint(now) + self._too_long(now)

    def tick(self, now: float, wall: float) -> list[Event]:
        """What follows from the time alone; to be called at least twice a second."""
        away, self._looked = now - self._looked, now
        if self._last_sign is not None and away > AWAY:
            self._last_sign = min(now, self._last_sign + away)
        events = self._handle(self._decoder.expire(now), now, wall)
        if self._last_sign is None:
            return events + self._wait_for_answer(now)
        silent = now - self._last_sign
        ours = self._announcements.is_our_firmware
        if silent >= self._patience():
            sign = "time request" if ours else "sign of life"
            reason = f"no {sign} for {silent:.0f} s and no answer to the topic request{self._noise()}"
            return [*events, Lost(reason)]
        return events + (self._ask(now, SILENCE_ASK_PERIOD if ours else SKETCH_ASK_PERIOD) if silent >= SILENCE else [])

    def _wait_for_answer(self, now: float) -> list[Event]:
        waited = now - self._started
        if waited >= self._answer_within:
            return [Lost(f"no answer to the topic request within {self._answer_within:g} s{self._seen()}")]
        asked = self._ask(now, ASK_PERIOD)
        if waited < ANSWER_EXPECTED or self._answer_is_late:
            return asked
        self._answer_is_late = True
        late = f"no answer to the topic request for {waited:.0f} s{self._seen()}: waiting for {self._answer_within:g} s"
        return [*asked, Notice(late)]

    def _patience(self) -> float:
        """s of silence after which the device is given up."""
        if self._announcements.is_our_firmware:
            return SILENCE + SILENCE_AFTER_ASKING
        # while a long frame is on the line, nothing else is
        return SKETCH_SILENCE + min(self._announcements.largest_buffer, MAX_PAYLOAD) * self._byte_time

    def _complaint(self, now: float) -> list[Event]:
        """A line about what was not understood, when that has grown, at most one per NOISE_PERIOD."""
        told_at, told = self._noise_told
        noise = self._noise()
        if noise == told or now - told_at < NOISE_PERIOD:
            return []
        self._noise_told = (now, noise)
        return [Notice(f"noise on the serial line so far{noise}")]

    def _too_long(self, now: float) -> list[Event]:
        """Likewise about frames that are longer than the device has said. One that has not said anything yet goes on
        with an earlier conversation, and may send them."""
        told_at, told = self._too_long_told
        count, longest = self._decoder.too_long, self._decoder.longest
        if count == told or now - told_at < NOISE_PERIOD or not self.answered:
            return []
        self._too_long_told = (now, count)
        return [
            Notice(
                f"dropped a frame of {self._decoder.last_too_long} bytes from the device ({count} so far): its limit "
                f"is {longest} bytes; enlarge the buffers in its sketch"
            )
        ]

    def _noise(self) -> str:
        bad, garbage = self._decoder.bad_frames - self._decoder.too_long, self._decoder.garbage
        return f" ({bad} broken frames, {garbage} stray bytes: wrong speed or sketch?)" if bad or garbage else ""

    def _seen(self) -> str:
        """What has come in place of an answer."""
        if self._others:
            return f" ({self._others} other frames came, as from a sketch that does not tell its topics)"
        return self._noise() or " (nothing came at all: no sketch, another port, or one that is still starting?)"

    def _ask(self, now: float, period: float) -> list[Event]:
        if self._asked is not None and now - self._asked < period:
            return []
        self._asked = now
        return [Send(ids.TOPIC_REQUEST)]

    def _handle(self, frames: Iterable[Frame], now: float, wall: float) -> list[Event]:
        return [event for frame in frames for event in self._handle_frame(frame, now, wall)]

    def _handle_frame(self, frame: Frame, now: float, wall: float) -> list[Event]:
        if not self.answered:  # anything else is from an earlier conversation: the topics are still to come
            self._others += frame.topic_id not in KINDS
        elif not self._announcements.is_our_firmware or frame.topic_id == ids.TIME:
            self._last_sign = now
        if frame.topic_id >= ids.FIRST_TOPIC:
            return self._message(frame, now)
        if frame.topic_id in KINDS:
            return self._topic(frame, now)
        if frame.topic_id == ids.TIME:
            return self._time(wall)
        return _aside(frame)

    def _topic(self, frame: Frame, now: float) -> list[Event]:
        try:
            event = self._announcements.told(frame.topic_id, frame.payload)
        except ValueError as error:
            return [Notice(str(error))]
        except TooManyTopicsError as error:
            return [Lost(str(error))]
        told = min(self._announcements.largest_buffer, MAX_PAYLOAD)
        self._decoder.longest = max(self._decoder.longest, told)
        self._last_sign = now
        return [event] if event else []

    def _message(self, frame: Frame, now: float) -> list[Event]:
        if frame.topic_id in self._announcements.sent_by_device:
            return [Message(frame.topic_id, frame.payload)]
        # a device that still counts on an earlier conversation, or whose topic info got lost
        asking = self._ask(now, ASK_PERIOD)
        notice = Notice(f"message on unknown topic id {frame.topic_id}: asking for the topics again")
        return [notice, *asking] if asking else []

    def _time(self, wall: float) -> list[Event]:
        secs, fraction = divmod(wall, 1)
        return [Send(encode(ids.TIME, struct.pack("<II", int(secs), int(fraction * 1e9))))]


def _aside(frame: Frame) -> list[Event]:
    """Frames that do not touch the conversation."""
    if frame.topic_id == ids.LOG:
        return [_log(frame.payload)]
    if frame.topic_id == ids.PARAMETER:
        return [ParameterRequest(frame.payload[4:].decode(errors="replace"))]
    return [Notice(f"frame with unknown id {frame.topic_id} ignored")]


def _log(payload: bytes) -> DeviceLog | Notice:
    """rosserial_msgs/Log: u8 level, string."""
    if len(payload) < 5 or len(payload) != 5 + int.from_bytes(payload[1:5], "little"):
        return Notice(f"broken log message of {len(payload)} bytes ignored")
    return DeviceLog(payload[0], payload[5:].decode(errors="replace"))
