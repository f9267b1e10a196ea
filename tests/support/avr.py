"""Virtual robots (the real firmware in build/sim/avr_robot) and what stands around them: an arena and a serial host."""

import contextlib
import functools
import socket
import struct
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import psutil
import serial

from tests.support.polling import until
from tests.support.programs import ROOT, Program

FIRMWARE = ROOT / "build/firmware/laserbot.elf"
AVR_ROBOT = ROOT / "build/sim/avr_robot"
OPTIBOOT = ROOT / "build/sim/optiboot.hex"
CYCLES_PER_SECOND = 16_000_000
STARTED = CYCLES_PER_SECOND // 5  # on the clock of an AVR whose firmware has told its topics

REQUEST_TOPICS = bytes.fromhex("ff fe 00 00 ff 00 00 ff")
HIT = bytes.fromhex("ff fe 00 00 ff 7d 00 82")
COMMAND_ID = 100
RESPONSE_ID = 125
TIME_ID = 10
TOPICS = 6  # that the firmware tells


@functools.cache
def build() -> None:
    """Build the firmware, the simulator and its boot loader; quick when they are up to date."""
    for goals in (["firmware"], ["sim", "all", "optiboot"]):
        subprocess.run(["make", "-s", "-C", *goals], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)


def frame(topic_id: int, payload: bytes = b"") -> bytes:
    """A rosserial frame (behaviour of protocol version 2)."""
    length = len(payload).to_bytes(2, "little")
    body = topic_id.to_bytes(2, "little") + payload
    return b"\xff\xfe" + length + bytes([255 - sum(length) % 256]) + body + bytes([255 - sum(body) % 256])


def command(linear_x: int, angular_z: int, shoot: bool = False) -> bytes:
    """The frame of a Robot_msg for the robot."""
    return frame(COMMAND_ID, bytes([linear_x & 0xFF, angular_z & 0xFF, shoot]))


class Frame(NamedTuple):
    topic_id: int
    payload: bytes


def split_frames(received: bytes) -> list[Frame]:
    """The whole frames of a stream that has nothing else in it; AssertionError at the first wrong byte."""
    frames = []
    while len(received) >= 8:
        length = int.from_bytes(received[2:4], "little")
        if len(received) < length + 8:
            break
        topic_id, payload = int.from_bytes(received[5:7], "little"), received[7 : 7 + length]
        assert received[: length + 8] == frame(topic_id, payload), f"corrupt at {received[:40]!r}"
        frames.append(Frame(topic_id, payload))
        received = received[length + 8 :]
    return frames


class Event(NamedTuple):
    """A line of the trace: when by the monotonic clock (ns), when by the AVR (cycles since power-on), what."""

    ns: int
    cycles: int
    words: list[str]


class AvrRobot:
    """A running avr_robot with a trace. Its events are parsed as they come."""

    def __init__(
        self, *uart: str | Path, name: str = "virtual0", arena: str | None = None, firmware: Path = FIRMWARE
    ) -> None:
        build()
        link = ["--arena", arena] if arena else []
        arguments = ["--firmware", firmware, "--name", name, *uart, *link, "--trace"]
        self.program = Program([str(word) for word in [AVR_ROBOT, *arguments]])
        self._parsed = 0
        self._events: list[Event] = []
        self.program.wait_for(" tick\n")
        # it has told its topics by now, and who opens its UART does not hear the rest of them only
        until(lambda: self.now >= STARTED, 10, "it has started")

    @property
    def uart(self) -> str:
        """Where the UART is, as the program says: the link's path or HOST:PORT."""
        return self.program.wait_for("UART at ").split("UART at ", 1)[1].split("\n", 1)[0]

    @property
    def events(self) -> list[Event]:
        """All events so far."""
        output = self.program.output
        end = output.rfind("\n") + 1
        for line in output[self._parsed : end].splitlines():
            words = line.split()
            if words and words[0].isdecimal():
                self._events.append(Event(int(words[0]), int(words[1]), words[2:]))
        self._parsed = end
        return self._events

    def mark(self) -> int:
        """A point in the trace, for `since`: whatever has happened until now lies before it."""
        return len(self.events)

    def cycles_of(self, *words: str, since: int = 0) -> list[int]:
        """When (cycles) the events after the mark `since` happened that begin with `words`."""
        return [event.cycles for event in self.events[since:] if event.words[: len(words)] == [*words]]

    def steps(self, wheel: str, since: int = 0) -> list[tuple[int, int]]:
        """The half-steps of the wheel left or right after the mark `since`: (cycle, position after it)."""
        return [
            (event.cycles, int(event.words[2])) for event in self.events[since:] if event.words[:2] == ["coil", wheel]
        ]

    def position(self, wheel: str) -> int:
        steps = self.steps(wheel)
        return steps[-1][1] if steps else 0

    def last_step(self) -> int:
        """The cycle of the last half-step of either wheel."""
        return max([*self.cycles_of("coil"), 0])

    @property
    def now(self) -> int:
        """The cycle that the AVR has reached, 10 ms exact."""
        return self.events[-1].cycles

    @property
    def cpu_seconds(self) -> float:
        """CPU time that the program has used."""
        times = psutil.Process(self.program.process.pid).cpu_times()
        return times.user + times.system

    def let_pass(self, seconds: float) -> None:
        """Wait until the robot has lived `seconds` longer."""
        end = self.now + int(seconds * CYCLES_PER_SECOND)
        until(lambda: self.now >= end, seconds + 5)

    def wait_until_still(self, seconds: float = 5.0) -> None:
        """Wait until no wheel has moved for 50 ms (a half-step takes 1.4 ms at most)."""
        until(lambda: self.now - self.last_step() > CYCLES_PER_SECOND // 20, seconds, "wheels still")

    def stop(self) -> None:
        assert self.program.stop() == 0, self.program.output


@contextlib.contextmanager
def avr_robot(
    *uart: str | Path, name: str = "virtual0", arena: str | None = None, firmware: Path = FIRMWARE
) -> Iterator[AvrRobot]:
    """An AvrRobot for a while; it must end cleanly."""
    robot = AvrRobot(*uart, name=name, arena=arena, firmware=firmware)
    try:
        yield robot
        robot.stop()
    finally:
        robot.program.kill()


class SerialHost:
    """The other end of the robot's serial cable; keeps all that the robot has said."""

    def __init__(self, url: str) -> None:
        self._port = serial.serial_for_url(url, baudrate=57600, timeout=0, write_timeout=5)
        self.received = b""

    def send(self, data: bytes) -> None:
        self._port.write(data)

    @property
    def frames(self) -> list[Frame]:
        """All frames so far."""
        while data := self._port.read(4096):
            self.received += data
        return split_frames(self.received)

    def count(self, topic_id: int) -> int:
        return sum(frame.topic_id == topic_id for frame in self.frames)

    def negotiate(self) -> None:
        """Ask for the topics and wait for the whole answer: from now on the robot reports hits."""
        self.send(REQUEST_TOPICS)
        until(lambda: self.count(0) + self.count(1) >= TOPICS, 5, "descriptions of all topics")

    def stream(self, data: bytes, seconds: float, hz: float = 40.0) -> None:
        """Send `data` again and again, as a player's page does with commands."""
        start = time.monotonic()
        for number in range(int(seconds * hz)):
            self.send(data)
            time.sleep(max(0.0, start + (number + 1) / hz - time.monotonic()))

    def close(self) -> None:
        self._port.close()


class ArenaLink:
    """One robot's connection, seen from the arena."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._connection.setblocking(False)
        self._received = b""
        self.closed = False

    @property
    def lines(self) -> list[str]:
        """All whole lines so far."""
        with contextlib.suppress(BlockingIOError, ConnectionError):
            while data := self._connection.recv(65536):
                self._received += data
            self.closed = True
        return self._received.decode().split("\n")[:-1]

    def wait_for(self, line: str) -> None:
        until(lambda: line in self.lines, 5, f"{line!r} from the robot; got {self.lines[:10]}")

    def hello(self) -> list[str]:
        """The first three lines: name, wheels, beam."""
        until(lambda: len(self.lines) >= 3, 5, "hello of the robot")
        return self.lines[:3]

    def send(self, text: str) -> None:
        self._connection.setblocking(True)
        self._connection.sendall(text.encode())
        self._connection.setblocking(False)

    def close(self) -> None:
        self._connection.close()


class Arena:
    """A stand-in for the arena: accepts robots and does what the test says."""

    def __init__(self, port: int = 0) -> None:
        self._listener = socket.create_server(("127.0.0.1", port))
        self._listener.settimeout(5)
        self.port = int(self._listener.getsockname()[1])
        self.address = f"127.0.0.1:{self.port}"
        self._links: list[ArenaLink] = []

    def accept(self) -> ArenaLink:
        link = ArenaLink(self._listener.accept()[0])
        self._links.append(link)
        return link

    def close(self) -> None:
        for link in self._links:
            link.close()
        self._listener.close()


def connect(robot: AvrRobot) -> SerialHost:
    """The host at the serial port of a robot that has it on TCP."""
    return SerialHost(f"socket://{robot.uart}")


def run_avr_robot(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """avr_robot, which is to end at once."""
    build()
    words = [str(word) for word in [AVR_ROBOT, *arguments]]
    return subprocess.run(words, capture_output=True, text=True, timeout=10, check=False)


def assert_refused(result: subprocess.CompletedProcess[str], code: int, reason: str) -> None:
    """One line on stderr that holds the reason, nothing on stdout."""
    assert result.returncode == code
    assert reason in result.stderr
    assert result.stderr.startswith("avr_robot: ")
    assert result.stderr.count("\n") == 1
    assert result.stdout == ""


def elf_of(*words: int) -> bytes:
    """A minimal AVR ELF file with these instructions at address 0."""
    code = struct.pack(f"<{len(words)}H", *words)
    ident = b"\x7fELF" + bytes([1, 1, 1]) + bytes(9)
    header = struct.pack("<HHIIIIIHHHHHH", 2, 83, 1, 0, 52, 0, 0, 52, 32, 1, 0, 0, 0)
    return ident + header + struct.pack("<IIIIIIII", 1, 84, 0, 0, len(code), len(code), 5, 2) + code
