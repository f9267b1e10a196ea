"""The serial line at work: the conversation with the device, the commands and the dead-men."""

import logging
import math
import select
import threading
import time

from laser_bot_battle.msg import Robot_msg
from robot.dead_man import DeadMan
from robot.device_topics import DeviceTopics, serialised
from robot.rosserial.frame import encode
from robot.rosserial.host import (
    STOP_SENDING,
    DeviceLog,
    DevicePublishes,
    DeviceSubscribes,
    Event,
    Host,
    Lost,
    Message,
    Notice,
    Send,
)
from robot.rosserial.topic_info import TopicInfo
from robot.serial_port import BAUDRATE, PortError, SerialPort
from robot.transmit_queue import TransmitQueue
from robot.waker import Waker

TICK = 0.5  # s, longest wait without looking at the time, and whether a signal came just before the wait
DEVICE_LEVELS = (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR, logging.CRITICAL)

_log = logging.getLogger(__name__)
_device_log = logging.getLogger("robot.arduino")


class SerialLine:
    """`run` reads the device and keeps the deadlines; commands are written by rospy's threads that receive them, as
    waking another thread for each would cost more than all the rest."""

    def __init__(self, port: SerialPort, waker: Waker) -> None:
        self._port = port
        self._waker = waker
        self._topics = DeviceTopics(self._command)
        self._host = Host(time.monotonic())
        self._lock = threading.Lock()  # for all below, and for writing to the port
        self._queue = TransmitQueue(BAUDRATE)
        self._dead_men: dict[int, DeadMan] = {}
        self._wakes_at = 0.0  # when `run` looks again at what is due
        self._failure: PortError | None = None  # met by a command
        self._ends = False

    def run(self) -> str:
        """Work until the waker says to end and return that reason; PortError when the device is lost.

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
                for event in self._host.receive(data, now, wall) + self._host.tick(now, wall):
                    self._handle(event)
                wait = self._do_what_is_due()
        finally:
            with self._lock:
                self._ends = True
        self._stop_device()
        return self._waker.ended

    def _do_what_is_due(self) -> float:
        """Returns how long to wait for more, s."""
        with self._lock:
            if self._failure is not None:
                raise self._failure
            now = time.monotonic()
            for topic_id, dead_man in self._dead_men.items():
                if dead_man.expired(now):
                    self._queue.command(topic_id, encode(topic_id, dead_man.neutral))
            self._transmit(now)
            self._wakes_at = min(now + TICK, self._next_due())
            return max(0.0, self._wakes_at - now)

    def _command(self, topic: TopicInfo, payload: bytes) -> None:
        """Called from rospy's threads."""
        if len(payload) > topic.buffer_size:
            _log.warning(
                "message of %d bytes for %s dropped: longer than the device's buffer of %d",
                len(payload),
                topic.topic_name,
                topic.buffer_size,
            )
            return
        frame = encode(topic.topic_id, payload)
        with self._lock:
            if self._ends:
                return
            now = time.monotonic()
            if topic.topic_id in self._dead_men:
                self._dead_men[topic.topic_id].command(payload, now)
            self._queue.command(topic.topic_id, frame)
            try:
                self._transmit(now)
            except PortError as error:
                self._failure, self._ends = error, True
                self._waker.wake()
            # a stream of commands only puts the dead-man off, and wakes nobody
            if self._next_due() < self._wakes_at:
                self._waker.wake()

    def _transmit(self, now: float) -> None:
        if out := self._queue.take(now):
            self._port.write(out)

    def _next_due(self) -> float:
        deadlines = [dead_man.deadline for dead_man in self._dead_men.values()]
        return min((due for due in [*deadlines, self._queue.due] if due is not None), default=math.inf)

    def _stop_device(self) -> None:
        """Its last words: commands are not written any more."""
        for topic_id, dead_man in self._dead_men.items():
            self._port.write(encode(topic_id, dead_man.neutral))
        self._port.write(STOP_SENDING)

    def _handle(self, event: Event) -> None:
        match event:
            case Send(data):
                with self._lock:
                    self._queue.send(data)
            case DevicePublishes(info):
                self._topics.publish_for(info)
            case DeviceSubscribes(info):
                if info.message_type == Robot_msg._type:
                    with self._lock:
                        self._dead_men.setdefault(info.topic_id, DeadMan(neutral=serialised(Robot_msg())))
                self._topics.subscribe_for(info)
            case Message(topic_id, payload):
                self._topics.publish(topic_id, payload)
            case DeviceLog(level, text):
                _device_log.log(DEVICE_LEVELS[min(level, len(DEVICE_LEVELS) - 1)], "%s", text)
            case Notice(text):
                _log.warning("%s", text)
            case Lost(reason):
                raise PortError(f"{self._port.device}: {reason}")
