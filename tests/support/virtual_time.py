"""The real firmware in an Uno in virtual time: it runs as long as a test says, the same each time, and faster."""

import contextlib
import ctypes
import functools
import itertools
import os
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path

from tests.support.avr import (
    CYCLES_PER_SECOND,
    FIRMWARE,
    REQUEST_TOPICS,
    TIME_ID,
    Frame,
    build,
    frame,
    split_frames,
)
from tests.support.programs import ROOT

SOURCE = ROOT / "tests/support/avr_programs/virtual_time.c"
PARTS = ["board", "bootloader", "emitter", "firmware_image", "receiver", "stepper", "trace", "uart"]
MS = CYCLES_PER_SECOND // 1000
US = MS // 1000

SETUP_ID, IDENTIFY_ID, HIT_ID, BOARD_ID = 101, 102, 126, 127
PLAIN, CODED = 0, 1


@functools.cache
def _library() -> ctypes.CDLL:
    build()
    library = ROOT / "build/sim" / f"virtual_time.{os.getpid()}.so"
    sim = ROOT / "sim/avr_robot"
    sources = [SOURCE, *(sim / f"{part}.c" for part in PARTS)]
    flags = ["-O2", "-std=c11", "-D_GNU_SOURCE", "-shared", "-fPIC", f"-I{sim}"]
    subprocess.run(["gcc", *flags, "-o", library, *sources, "-lsimavr", "-lelf"], check=True)
    loaded = ctypes.CDLL(str(library))
    library.unlink()
    loaded.uno_new.restype = ctypes.c_void_p
    for name in ("uno_cycle", "uno_awake_until", "uno_sent", "uno_carrier_edges"):
        getattr(loaded, name).restype = ctypes.c_uint64
    loaded.uno_position.restype = ctypes.c_int64
    loaded.uno_beam.restype = ctypes.c_bool
    return loaded


def setup(robot: int, team: int = 0, mode: int = CODED, cooldown: int = 500, damage: int = 0) -> bytes:
    """The frame of a Setup."""
    return frame(SETUP_ID, bytes([robot & 0xFF, team, mode, *cooldown.to_bytes(2, "little"), damage]))


class Uno:
    """A virtual Uno with its host, which answers questions for the time by itself once `connect` was called."""

    def __init__(self, firmware: Path = FIRMWARE, bootloader: Path | None = None, coded: bool = True) -> None:
        self._call = _library()
        names = [str(path).encode() if path else None for path in (firmware, bootloader)]
        self._uno = ctypes.c_void_p(self._call.uno_new(*names, coded))
        assert self._uno
        self._received = b""
        self.answers = False  # questions for the time and new descriptions of the topics
        self.setup: bytes | None = None  # sent when the topics were told
        self.frames: list[tuple[int, Frame]] = []  # when (cycle) and what the Arduino has said
        self.carrier: list[int] = []  # edges of its own carrier: cycles, on and off in turn
        self.beam: list[tuple[int, bool]] = []
        self.steps: list[tuple[int, int, int]] = []  # cycle, left, right

    def close(self) -> None:
        self._call.uno_delete(self._uno)

    @property
    def now(self) -> int:
        return int(self._call.uno_cycle(self._uno))

    def send(self, data: bytes) -> None:
        self._call.uno_receive(self._uno, data, ctypes.c_size_t(len(data)))

    def run(self, seconds: float, commands: bytes | None = None) -> None:
        """Live on; with `commands` 40 times a second."""
        end = self.now + int(seconds * CYCLES_PER_SECOND)
        next_command = self.now
        while self.now < end:
            if commands and self.now >= next_command:
                next_command += 25 * MS
                self.send(commands)
            self._call.uno_run_until(self._uno, ctypes.c_uint64(min(self.now + MS // 4, end)))
            self._listen()

    def awake(self, seconds: float) -> float:
        """Live on, and the part of the time for which the CPU does not sleep."""
        start = self.now
        awake = self._call.uno_awake_until(self._uno, ctypes.c_uint64(start + int(seconds * CYCLES_PER_SECOND)))
        self._listen()
        return float(awake) / (self.now - start)

    def _listen(self) -> None:
        data = ctypes.create_string_buffer(256)
        length = self._call.uno_sent(self._uno, data)
        self._received += data.raw[:length]
        edges = (ctypes.c_uint64 * 64)()
        length = self._call.uno_carrier_edges(self._uno, edges)
        self.carrier += edges[:length]
        beam = bool(self._call.uno_beam(self._uno))
        if beam != (self.beam[-1][1] if self.beam else False):
            self.beam.append((self.now, beam))
        place = (self.position("left"), self.position("right"))
        if place != (self.steps[-1][1:] if self.steps else (0, 0)):
            self.steps.append((self.now, *place))
        self._answer()

    def _answer(self) -> None:
        new, rest = _whole_frames(self._received)
        self._received = rest
        for said in new:
            self.frames.append((self.now, said))
            if not self.answers:
                continue
            if said.topic_id == TIME_ID:
                self.send(frame(TIME_ID, bytes(8)))
            if said.topic_id == 1 and said.payload[0] == SETUP_ID and self.setup:
                self.send(self.setup)

    def connect(self, setup: bytes | None = None) -> None:
        """Negotiate, as a serial node that has this Setup."""
        self.setup = setup
        self.answers = True
        self.send(REQUEST_TOPICS)
        self.run(0.15)

    def said(self, topic_id: int, since: int = 0) -> list[tuple[int, bytes]]:
        """When (cycle) and what it has said on a topic after cycle `since`."""
        return [(cycle, said.payload) for cycle, said in self.frames if said.topic_id == topic_id and cycle > since]

    def position(self, wheel: str) -> int:
        return int(self._call.uno_position(self._uno, wheel == "right"))

    def light(self, marks: Iterable[int], after_us: int = 0) -> None:
        """A packet at the receiver: its marks and spaces in us; it is seen 5 ms later."""
        cycle = self.now + after_us * US
        for number, us in enumerate([*marks, 0]):
            self._call.uno_carrier(self._uno, ctypes.c_uint64(cycle), number % 2 == 0)
            cycle += us * US

    def shine(self, on: bool) -> None:
        """Plain light."""
        self._call.uno_shine(self._uno, on)

    def flip(self, address: int, bit: int) -> None:
        """Disturb one bit of the RAM."""
        self._call.uno_flip(self._uno, address, bit)

    def hang(self) -> None:
        """Let the program run in an endless loop; interrupts go on."""
        self._call.uno_hang(self._uno)

    def reset(self) -> None:
        """Press its button."""
        self._received = b""
        self._call.uno_reset(self._uno)

    def peek(self, address: int) -> int:
        return int(self._call.uno_peek(self._uno, address)) & 0xFF


def _whole_frames(received: bytes) -> tuple[list[Frame], bytes]:
    """The frames and what may be the beginning of one; a disturbed Arduino may say other things in between."""
    frames: list[Frame] = []
    while (start := received.find(b"\xff\xfe")) >= 0:
        received = received[start:]
        length = int.from_bytes(received[2:4], "little") if len(received) > 4 else 0
        if len(received) < 5 or (sum(received[2:5]) & 0xFF == 0xFF and length < 256 and len(received) < length + 8):
            return frames, received
        if sum(received[2:5]) & 0xFF == 0xFF and length < 256 and sum(received[5 : length + 8]) & 0xFF == 0xFF:
            frames += split_frames(received[: length + 8])
            received = received[length + 8 :]
        else:
            received = received[1:]
    return frames, received[-1:] if received.endswith(b"\xff") else b""


@contextlib.contextmanager
def uno(firmware: Path = FIRMWARE, bootloader: Path | None = None, coded: bool = True) -> Iterator[Uno]:
    """An Uno for a while; `coded`: with a receiver for coded light."""
    one = Uno(firmware, bootloader, coded)
    try:
        yield one
    finally:
        one.close()


def lengths(cycles: list[int]) -> list[float]:
    """us between edges."""
    return [(later - earlier) / US for earlier, later in itertools.pairwise(cycles)]
