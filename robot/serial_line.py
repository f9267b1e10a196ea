"""The serial line at work: one thread that owns the port, the conversation and the dead-men."""

import logging
import select
import time

from laser_bot_battle.msg import Robot_msg
from robot.dead_man import DeadMan
from robot.device_topics import DeviceTopics, serialised
from robot.mailbox import Mailbox
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
from robot.serial_port import BAUDRATE, PortError, SerialPort
from robot.transmit_queue import TransmitQueue

TICK = 0.1  # s, longest wait without looking at the time
DEVICE_LEVELS = (logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR, logging.CRITICAL)

_log = logging.getLogger(__name__)
_device_log = logging.getLogger("robot.arduino")


class SerialLine:
    def __init__(self, port: SerialPort, mailbox: Mailbox) -> None:
        self._port = port
        self._mailbox = mailbox
        self._topics = DeviceTopics(mailbox.put)
        self._host = Host(time.monotonic())
        self._queue = TransmitQueue(BAUDRATE)
        self._dead_men: dict[int, DeadMan] = {}

    def run(self) -> str:
        """Work until the mailbox says to end and return that reason; PortError when the device is lost."""
        while self._mailbox.ended is None:
            sources = [self._port.fileno(), self._mailbox.fileno()]
            ready, _, _ = select.select(sources, [], [], self._longest_wait())
            data = self._port.read() if self._port.fileno() in ready else b""
            now, wall = time.monotonic(), time.time()
            for event in self._host.receive(data, now, wall) + self._host.tick(now, wall):
                self._handle(event)
            for topic_id, payload in self._mailbox.take().items():
                self._command(topic_id, payload, now)
            for topic_id, dead_man in self._dead_men.items():
                if dead_man.expired(now):
                    self._command(topic_id, dead_man.neutral, now)
            if out := self._queue.take(now):
                self._port.write(out)
        return self._mailbox.ended

    def stop_device(self) -> None:
        """Leave the device neutral and silent."""
        for topic_id, dead_man in self._dead_men.items():
            self._port.write(encode(topic_id, dead_man.neutral))
        self._port.write(STOP_SENDING)

    def _longest_wait(self) -> float:
        due = [dead_man.deadline for dead_man in self._dead_men.values()] + [self._queue.due]
        return max(0.0, min([TICK, *(time_ - time.monotonic() for time_ in due if time_ is not None)]))

    def _command(self, topic_id: int, payload: bytes, now: float) -> None:
        info = self._topics.info(topic_id)
        if info is None:
            return
        if len(payload) > info.buffer_size:
            _log.warning(
                "message of %d bytes for %s dropped: longer than the device's buffer of %d",
                len(payload),
                info.topic_name,
                info.buffer_size,
            )
            return
        if topic_id in self._dead_men:
            self._dead_men[topic_id].command(payload, now)
        self._queue.command(topic_id, encode(topic_id, payload))

    def _handle(self, event: Event) -> None:
        match event:
            case Send(data):
                self._queue.send(data)
            case DevicePublishes(info):
                self._topics.publish_for(info)
            case DeviceSubscribes(info):
                self._topics.subscribe_for(info)
                if info.message_type == Robot_msg._type:
                    self._dead_men.setdefault(info.topic_id, DeadMan(neutral=serialised(Robot_msg())))
            case Message(topic_id, payload):
                self._topics.publish(topic_id, payload)
            case DeviceLog(level, text):
                _device_log.log(DEVICE_LEVELS[min(level, len(DEVICE_LEVELS) - 1)], "%s", text)
            case Notice(text):
                _log.warning("%s", text)
            case Lost(reason):
                raise PortError(f"{self._port.device}: {reason}")
