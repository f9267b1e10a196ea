"""A rosserial device on a pseudo-terminal: what a sketch does on the wire, with every byte recorded."""

import os
import pty
import select
import struct
import threading
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Self

from robot.rosserial.frame import Decoder, Frame, encode
from robot.rosserial.topic_info import TopicInfo

ROBOT_MSG = ("laser_bot_battle/Robot_msg", "aa81278360e1bdd1ffce0a4efe0ae199")
EMPTY = ("std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e")

COMMAND = TopicInfo(100, "command", *ROBOT_MSG, 280)
RESPONSE = TopicInfo(125, "response", *EMPTY, 280)

TOPIC_REQUEST = bytes.fromhex("ff fe 00 00 ff 00 00 ff")
STOP_SENDING = bytes.fromhex("ff fe 00 00 ff 0b 00 f4")


class Device:
    """Answers topic requests with its topics while `answers` is true; a context manager."""

    def __init__(
        self,
        path: Path,
        subscribers: tuple[TopicInfo, ...] = (COMMAND,),
        publishers: tuple[TopicInfo, ...] = (RESPONSE,),
        halves: tuple[tuple[int, TopicInfo], ...] = (),
    ) -> None:
        """`halves` of services, with the ids under which they are told."""
        self.path = str(path)
        self.answers = True
        self.received = bytearray()
        self.frames: list[Frame] = []
        self.topic_requests = 0
        self._subscribers = subscribers
        self._publishers = publishers
        self._halves = halves
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        path.symlink_to(os.ttyname(self._slave))
        os.set_blocking(self._slave, False)
        os.set_blocking(self._master, False)
        self._reading = threading.Lock()
        self._woken, self._wake = os.pipe()  # ends the thread
        self._thread = threading.Thread(target=self._run, name="device")

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()

    def send(self, data: bytes) -> None:
        """Returns when the line has taken all, or the device is unplugged."""
        while data:
            ended, ready, _ = select.select([self._woken], [self._master], [])
            if ended:
                return
            if ready:
                data = data[os.write(self._master, data) :]

    def payloads(self, topic_id: int) -> list[bytes]:
        """What came for that id, in order."""
        return [frame.payload for frame in self.frames if frame.topic_id == topic_id]

    def commands(self) -> list[bytes]:
        """The payloads that came for topic 100, in order."""
        return self.payloads(COMMAND.topic_id)

    @contextmanager
    def clogged(self) -> Iterator[None]:
        """The device reads nothing, and the line takes nothing more."""
        with self._reading:
            for size in 4096, 1, 1:  # the kernel has room for a byte where it has none for many
                with suppress(BlockingIOError):
                    while True:
                        os.write(self._slave, bytes(size))
                time.sleep(0.05)  # it moves what it has nearer to the reader, and has room again
            yield

    def unplug(self) -> None:
        """The device vanishes, as by pulling the cable."""
        if self._thread.is_alive():
            self.answers = False
            os.write(self._wake, b"\0")
            self._thread.join()
            for end in (self._woken, self._wake, self._slave, self._master):
                os.close(end)
            os.unlink(self.path)

    def _run(self) -> None:
        decoder = Decoder()
        decoder.longest = max(decoder.longest, *(info.buffer_size for info in self._subscribers))
        while self._woken not in select.select([self._master, self._woken], [], [])[0]:
            with self._reading:
                data = os.read(self._master, 4096)
            self.received += data
            for frame in decoder.feed(data, 0.0):
                self.frames.append(frame)
                if frame == Frame(0, b""):
                    self.topic_requests += 1
                    if self.answers:
                        self._tell_topics()

    def _tell_topics(self) -> None:
        """As ros_lib does: the time is asked for first, then the publishers and the subscribers are told."""
        answer = encode(10, struct.pack("<II", 0, 0))
        answer += b"".join(encode(0, info.encode()) for info in self._publishers)
        answer += b"".join(encode(1, info.encode()) for info in self._subscribers)
        answer += b"".join(encode(kind, info.encode()) for kind, info in self._halves)
        self.send(answer)
