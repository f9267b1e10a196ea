"""The serial line at work: the conversation with the device, the commands and the dead-men."""

import logging
import math
import select
import threading
import time

from laser_bot_battle.master import Master
from laser_bot_battle.msg import BoardHealth, Robot_msg, Setup
from robot.diagnostics import LineState
from robot.health import Board
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
)
from robot.rosserial.frame import MAX_PAYLOAD, USUAL_PAYLOAD, encode
from robot.rosserial.host import SILENCE, Host
from robot.rosserial.ids import STOP_SENDING
from robot.rosserial.log_budget import LogBudget
from robot.rosserial.topic_info import TopicInfo
from robot.serial.connection import LOOK_AGAIN
from robot.serial.dead_man import DeadMan
from robot.serial.device_log import DeviceLogger
from robot.serial.device_topics import deserialised, serialised
from robot.serial.endpoints import Endpoints
from robot.serial.parameters import Parameters
from robot.serial.port import PortError, SerialPort, lost
from robot.serial.transmit_queue import BITS_PER_BYTE, TransmitQueue
from robot.serial.waker import Waker

HEAR_AGAIN = 2.0  # s between two looks for a publisher that was missed
MAX_BROKEN = 50  # frames by TCP, which loses nothing; each may cost a look at all that came
TICK = 0.5  # s, longest wait without looking at the time, and whether a signal came just before the wait

_log = logging.getLogger(__name__)


class SerialLine:
    """`run` reads the device and keeps the deadlines; commands are written by rospy's threads that receive them, as
    waking another thread for each would cost more than all the rest."""

    def __init__(self, port: SerialPort, waker: Waker, master: Master, answer_within: float) -> None:
        """`port` and `waker` are this line's alone; `master` is asked for parameters; `answer_within`: s."""
        self.board = Board()
        self._port = port
        self._waker = waker
        self._endpoints = Endpoints(
            self._command,
            lambda topic_id, payload: self._answer(encode(topic_id, payload)),
            {BoardHealth._type: self._heard_of_board},
            master,
        )
        self._parameters = Parameters(master, self._answer)
        self._device_log, self._log_budget = DeviceLogger(), LogBudget()
        self._host = Host(time.monotonic(), BITS_PER_BYTE / port.slowest, answer_within)
        self._room = USUAL_PAYLOAD  # bytes, of the device's buffer
        self._lock = threading.Lock()  # for all below, and for writing to the port
        self._queue = TransmitQueue(port.baudrate)
        self._dead_men: dict[int, DeadMan] = {}
        self._setups: dict[int, tuple[TopicInfo, bytes]] = {}  # the last one of each topic
        self._hears_again_at = time.monotonic() + HEAR_AGAIN
        self._wakes_at = 0.0  # when `run` looks again at what is due
        self._failure: PortError | None = None  # met by a command
        self._ends = False

    def run(self) -> str:
        """Work until the waker says to end and return that reason; PortError when the device is lost, NoAnswerError
        when it was never there.

        The device is left neutral and silent.
        """
        try:
            wait = 0.0
            while self._waker.ended is None:
                sources = [self._port.fileno(), self._waker.fileno()]
                ready, _, _ = select.select(sources, [], [], wait)
                if self._waker.fileno() in ready:
                    self._waker.clear()
                data = self._port.read() if self._port.fileno() in ready else b""
                now, wall = time.monotonic(), time.time()
                events = self._host.receive(data, now, wall) + self._host.tick(now, wall)
                if self._port.is_connection and self._host.broken_frames > MAX_BROKEN:
                    raise PortError("the board sends what is no rosserial")
                for event in self._log_budget.within(events, now):
                    self._handle(event)
                if now >= self._hears_again_at:
                    self._hears_again_at = now + HEAR_AGAIN
                    self._endpoints.hear_again()
                wait = self._do_what_is_due()
        finally:
            with self._lock:
                self._ends = True
        self._stop_device()
        return self._waker.ended

    def state(self) -> LineState:
        """How the conversation is now; for other threads."""
        silence = self._host.silence(time.monotonic())
        return LineState(
            silence=silence,
            mute=silence is not None and silence > SILENCE,
            broken_frames=self._host.broken_frames,
            stray_bytes=self._host.stray_bytes,
            dropped_answers=self._queue.refused,
        )

    def _do_what_is_due(self) -> float:
        """Returns how long to wait for more, s."""
        with self._lock:
            if self._failure is not None:
                raise self._failure
            now = time.monotonic()
            for topic_id, dead_man in self._dead_men.items():
                if dead_man.expired(now):
                    if not self._port.is_connection:  # which is fast, and does not keep the pause
                        self._queue.break_off(now)
                    self._queue.command(topic_id, encode(topic_id, dead_man.neutral))
            self._transmit(now)
            self._wakes_at = min(now + TICK, self._next_due())
            return max(0.0, self._wakes_at - now)

    def _command(self, topic: TopicInfo, payload: bytes) -> None:
        """Called from rospy's threads."""
        room = min(topic.buffer_size, MAX_PAYLOAD)
        if len(payload) > room:
            _log.warning(
                "message of %d bytes for %s dropped: longer than the device's buffer of %d",
                len(payload),
                topic.topic_name,
                room,
            )
            return
        frame = encode(topic.topic_id, payload)
        with self._lock:
            if self._ends:
                return
            now = time.monotonic()
            if topic.topic_id in self._dead_men:
                self._dead_men[topic.topic_id].command(payload, now)
            if topic.message_type == Setup._type:
                self._setups[topic.topic_id] = (topic, payload)
            self._queue.command(topic.topic_id, frame)
            self._transmit_soon(now)

    def _answer(self, frame: bytes) -> None:
        """Called from other threads: a frame of the protocol, or of a service."""
        with self._lock:
            if not self._ends:
                self._queue.send(frame)
                self._transmit_soon(time.monotonic())

    def _transmit_soon(self, now: float) -> None:
        """Now or, while the line is busy, by `run`."""
        try:
            self._transmit(now)
        except PortError as error:
            self._failure, self._ends = error, True
            self._waker.wake()
        # a stream of commands only puts the dead-man off, and wakes nobody
        if self._next_due() < self._wakes_at:
            self._waker.wake()

    def _transmit(self, now: float) -> None:
        if not self._port.is_clear():
            self._queue.hold(now + LOOK_AGAIN)
        elif out := self._queue.take(now):
            self._port.write(out)

    def _next_due(self) -> float:
        deadlines = [dead_man.deadline for dead_man in self._dead_men.values()]
        return min((due for due in [*deadlines, self._queue.due] if due is not None), default=math.inf)

    def _stop_device(self) -> None:
        """Its last words: commands are not written any more."""
        if self._port.is_connection:
            self._port.write(self._queue.rest())
        else:
            time.sleep(self._queue.break_off(time.monotonic()))
        for topic_id, dead_man in self._dead_men.items():
            self._port.write(encode(topic_id, dead_man.neutral))
        self._port.write(STOP_SENDING)

    def _handle(self, event: Event) -> None:
        match event:
            case Send(data):
                with self._lock:
                    self._queue.send(data)
            case DeviceSubscribes(info):
                self._subscribed(info)
                self._endpoints.tell(event)
            case DevicePublishes() | DeviceServes() | DeviceCalls():
                self._endpoints.tell(event)
            case Message(topic_id, payload):
                self._endpoints.receive(topic_id, payload)
            case ParameterRequest(name):
                self._parameters.ask(name, self._room)
            case DeviceLog(level, text):
                self._device_log.log(level, text)
            case Notice(text):
                _log.warning("%s", text)
            case Lost(reason):
                raise lost(self._port.device, self._host, reason)

    def _subscribed(self, info: TopicInfo) -> None:
        """The device tells that it subscribes, perhaps again: then it may have been reset, and have lost its setup."""
        self._room = info.buffer_size
        with self._lock:
            if info.message_type == Robot_msg._type:
                self._dead_men.setdefault(info.topic_id, DeadMan(neutral=serialised(Robot_msg())))
            setup = self._setups.get(info.topic_id)
        if setup is not None:
            self._command(info, setup[1])

    def _heard_of_board(self, board: BoardHealth) -> None:
        """A setup is sent again to a device that is in another mode: it was damaged on the line."""
        self.board.take(board, time.monotonic())
        with self._lock:
            setups = [*self._setups.values()]
        for topic, payload in setups:
            setup = deserialised(Setup, payload, topic.topic_name)
            if setup is not None and setup.mode != board.mode:
                self._command(topic, payload)
