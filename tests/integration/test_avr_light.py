"""The virtual Uno's light: the carrier that its timer makes, what its receiver sees, and what its ADC measures."""

import contextlib
import itertools
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial

from tests.support.avr import CYCLES_PER_SECOND, Arena, AvrRobot, assert_refused, avr_robot, run_avr_robot
from tests.support.polling import until
from tests.support.programs import ROOT

PROGRAM = ROOT / "tests/support/avr_programs/carrier.c"
MS = CYCLES_PER_SECOND // 1000
ENDS_BY_ITSELF = 50 * MS  # a mark that nobody ends
LENGTHENING = MS // 20  # of a mark, by a demodulating receiver

# TCCR2A with OC2B, TCCR2B, OCR2A
FAST = (0x23, 0x0A, 51)  # 38.5 kHz
PHASE_CORRECT = (0x21, 0x09, 210)  # 38.1 kHz
CTC = (0x12, 0x01, 209)  # 38.1 kHz


@pytest.fixture
def arena() -> Iterator[Arena]:
    arena = Arena()
    with contextlib.closing(arena):
        yield arena


def carrier_program(folder: Path, control_a: int, control_b: int, compare_a: int, output: int = 1) -> Path:
    """carrier.c with these registers of timer 2."""
    program = folder / "carrier.elf"
    registers = {"CONTROL_A": control_a, "CONTROL_B": control_b, "COMPARE_A": compare_a, "OUTPUT": output}
    defines = [f"-D{name}={value}" for name, value in registers.items()]
    subprocess.run(["avr-gcc", "-mmcu=atmega328p", "-Os", *defines, "-o", program, PROGRAM], check=True)
    return program


def edges(robot: AvrRobot, what: str) -> list[tuple[int, bool]]:
    """The changes of the robot's beam, carrier or light: (cycle, on)."""
    return [(event.cycles, event.words[1] == "1") for event in robot.events if event.words[0] == what]


def durations(robot: AvrRobot, what: str) -> list[int]:
    """Cycles between the changes: mark, space, mark ..."""
    times = [cycle for cycle, _ in edges(robot, what)]
    return [later - earlier for earlier, later in itertools.pairwise(times)]


# ---- the emitter -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("registers", [FAST, PHASE_CORRECT, CTC], ids=["fast", "phase correct", "ctc"])
def test_a_timer_at_38_khz_makes_a_carrier(tmp_path: Path, registers: tuple[int, int, int]) -> None:
    with avr_robot("--serial", tmp_path / "tty", firmware=carrier_program(tmp_path, *registers)) as robot:
        until(lambda: len(edges(robot, "carrier")) >= 6, 5, "carriers")
        first, space, second, pause, *_ = durations(robot, "carrier")

        assert [on for _, on in edges(robot, "carrier")[:4]] == [True, False, True, False]
        assert (first, space, second) == pytest.approx((1.2 * MS, 0.6 * MS, 1.2 * MS), abs=MS / 1000)
        assert pause == pytest.approx(40 * MS, rel=0.1)
        assert edges(robot, "beam") == []


@pytest.mark.parametrize(
    "registers",
    [(0x23, 0x0A, 46), (0x23, 0x08, 51), (0x03, 0x0A, 51), (*FAST, 0)],
    ids=["42.6 kHz", "no clock", "pin not the timer's", "pin not an output"],
)
def test_anything_else_makes_none(tmp_path: Path, registers: tuple[int, ...]) -> None:
    with avr_robot("--serial", tmp_path / "tty", firmware=carrier_program(tmp_path, *registers)) as robot:
        robot.let_pass(0.2)
        assert edges(robot, "carrier") == []
        assert edges(robot, "beam") == []


def test_the_arena_hears_of_edges_at_once_and_when_they_were(tmp_path: Path, arena: Arena) -> None:
    firmware = carrier_program(tmp_path, *FAST)
    with avr_robot("--serial", tmp_path / "tty", arena=arena.address, firmware=firmware) as robot:
        link = arena.accept()
        until(lambda: len([line for line in link.lines if line.startswith("carrier")]) >= 8, 5, "edges")
        told = [line.split()[1:] for line in link.lines if line.startswith("carrier")]
        times = [int(cycle) for _, cycle in told]

        changes = [word for n, word in enumerate(told) if n == 0 or word[0] != told[n - 1][0]]
        seen = [[str(int(on)), str(cycle)] for cycle, on in edges(robot, "carrier") if cycle >= times[0]]
        assert changes == seen[: len(changes)]
        assert times == sorted(times)
        steps = [later - earlier for earlier, later in itertools.pairwise(times) if later - earlier < 10 * MS]
        assert max(steps) < 1.1 * MS  # within a packet it says each ms how the carrier is


# ---- the receiver ----------------------------------------------------------------------------------------------------

PACKET = [(0, 1), (2400, 0), (3000, 1), (3600, 0), (4200, 1), (5400, 0)]  # us, on
MARKS_AND_SPACES = [2400, 600, 600, 600, 1200]


def lines(source: int, start_us: int, packet: list[tuple[int, int]] = PACKET) -> str:
    """A packet as the arena tells it, in the time of its source."""
    return "".join(f"carrier {source} {on} {(start_us + us) * 16}\n" for us, on in packet)


@pytest.mark.parametrize(("receiver", "lengthening"), [("plain", 0), ("coded", LENGTHENING)])
def test_a_packet_is_seen_as_it_was_made(tmp_path: Path, arena: Arena, receiver: str, lengthening: int) -> None:
    with avr_robot("--serial", tmp_path / "tty", "--receiver", receiver, arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        link.send(lines(3, 10**9))
        until(lambda: len(edges(robot, "light")) == len(PACKET), 5, "the packet")
        link.send(lines(3, 10**9 + 10**8))
        until(lambda: len(edges(robot, "light")) == 2 * len(PACKET), 5, "the next one")

        wanted = [us * 16 + (lengthening if n % 2 == 0 else -lengthening) for n, us in enumerate(MARKS_AND_SPACES)]
        seen = durations(robot, "light")
        assert seen[:5] == pytest.approx(wanted, abs=32)
        assert seen[6:] == pytest.approx(wanted, abs=32)
        assert robot.cycles_of("late") == []


def test_packets_at_once_are_seen_as_one_light(tmp_path: Path, arena: Arena) -> None:
    """Each in its source's time; the clocks have nothing to do with each other."""
    with avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        link.send(lines(1, 77, [(0, 1), (20_000, 0)]) + lines(0, 5_000_000))
        until(lambda: len(edges(robot, "light")) >= 2, 5, "light")

        robot.let_pass(0.02)
        assert durations(robot, "light") == pytest.approx([20 * MS], abs=32)


def test_the_avr_waits_for_the_rest_of_a_packet(tmp_path: Path, arena: Arena) -> None:
    """As long as a busy computer may be late; if this one is later still, another packet will do."""
    with avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        for start in range(10**6, 10**7, 10**6):
            first, *rest = lines(0, start).splitlines(keepends=True)
            before = len(edges(robot, "light"))
            link.send(first)
            sent = time.monotonic()
            until(lambda sent=sent: time.monotonic() - sent > 0.02, 5)
            link.send("".join(rest) + f"carrier 0 0 {(start + 10_000) * 16}\n")
            until(lambda before=before: len(edges(robot, "light")) == before + len(PACKET), 5, "the packet")
            if durations(robot, "light")[before:] == pytest.approx([us * 16 for us in MARKS_AND_SPACES], abs=32):
                break
        else:
            pytest.fail(f"all damaged: {durations(robot, 'light')}")


def test_light_that_comes_too_late_is_seen_late(tmp_path: Path, arena: Arena) -> None:
    with avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        for start in range(10**6, 10**8, 10**7):
            before = len(edges(robot, "light"))
            # longer than any mark of a packet: nobody waits
            link.send(f"carrier 0 1 {start}\ncarrier 0 1 {start + 64_000}\n")
            until(lambda before=before: len(edges(robot, "light")) > before, 5, "light")
            robot.let_pass(0.02)
            link.send(f"carrier 0 0 {start + 80_000}\ncarrier 0 1 {start + 96_000}\ncarrier 0 0 {start + 112_000}\n")
            until(lambda before=before: len(edges(robot, "light")) == before + 4, 5, "its end")
            mark, *others = durations(robot, "light")[before:]
            if mark < ENDS_BY_ITSELF:  # this computer has not stood still meanwhile
                break
        else:
            pytest.fail(f"no mark was ended in time: {durations(robot, 'light')}")

        assert mark > 19 * MS
        assert others == pytest.approx([MS, MS], abs=32)
        assert len(robot.cycles_of("late")) == before / 4 + 1


def test_a_mark_that_nobody_ends_ends_by_itself(tmp_path: Path, arena: Arena) -> None:
    with avr_robot("--serial", tmp_path / "tty", "--receiver", "coded", arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        link.send("carrier 2 1 16000\n")
        until(lambda: len(edges(robot, "light")) == 2, 5, "the end of the mark")
        assert durations(robot, "light") == pytest.approx([ENDS_BY_ITSELF], abs=MS)
        link.send("carrier 2 1 16000000\n")
        until(lambda: len(edges(robot, "light")) == 3, 5, "light again")
        arena.close()
        until(lambda: len(edges(robot, "light")) == 4, 5, "darkness")
        assert durations(robot, "light")[-1] < ENDS_BY_ITSELF


def test_a_demodulating_receiver_sees_no_plain_light(tmp_path: Path, arena: Arena) -> None:
    with avr_robot("--serial", tmp_path / "tty", "--receiver", "coded", arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        link.send("light 1\nlamp 1\n" + lines(0, 0))
        until(lambda: len(edges(robot, "light")) == len(PACKET), 5, "the packet")
        assert durations(robot, "light")[0] == pytest.approx(2400 * 16 + LENGTHENING, abs=32)


def test_a_lamp_flickers_100_times_a_second_for_a_phototransistor(tmp_path: Path, arena: Arena) -> None:
    with avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        link.send("lamp 1\n")
        until(lambda: len(edges(robot, "light")) > 20, 5, "light")
        found = durations(robot, "light")  # more come meanwhile
        assert found == pytest.approx([5 * MS] * len(found), abs=300)
        arena.close()
        until(lambda: robot.now - edges(robot, "light")[-1][0] > 50 * MS, 5, "the lamp has gone with the arena")
        assert not edges(robot, "light")[-1][1]


def test_nonsense_about_carriers_does_nothing(tmp_path: Path, arena: Arena) -> None:
    with avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        link.send("carrier 16 1 0\ncarrier 9999999999 1 0\ncarrier 0 2 0\ncarrier 0 1\ncarrier 0 1 5 x\n")
        link.send("".join(f"carrier 5 {n % 2} {n}\n" for n in range(1, 2000)))  # faster than anything can be followed
        link.send(lines(0, 0))
        until(lambda: edges(robot, "light"), 5, "what is good")
        until(lambda: robot.now - edges(robot, "light")[-1][0] > 100 * MS, 5, "an end of it")
        assert not edges(robot, "light")[-1][1]


# ---- the ADC ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "supply", "a0"), [([], 5000, 0), (["--supply", "4300", "--a0", "2100"], 4300, 2100)]
)
def test_the_adc_measures_the_supply_and_a0(tmp_path: Path, options: list[str], supply: int, a0: int) -> None:
    with (
        avr_robot("--serial", tmp_path / "tty", *options, firmware=carrier_program(tmp_path, *FAST)) as robot,
        contextlib.closing(serial.serial_for_url(robot.uart, baudrate=57600, timeout=5)) as port,
    ):
        port.readline()
        reference, battery = map(int, port.readline().split())

        assert 1100 * 1023 / reference == pytest.approx(supply, rel=0.01)
        assert battery / 1023 * supply == pytest.approx(a0, abs=5)


@pytest.mark.parametrize(
    ("option", "value", "reason"),
    [
        ("--receiver", "tv", "plain or coded"),
        ("--supply", "1799", "1800 to 5500"),
        ("--supply", "5501", "1800 to 5500"),
        ("--a0", "1.5", "0 to 5500"),
        ("--a0", "-1", "0 to 5500"),
    ],
)
def test_impossible_hardware_is_refused(option: str, value: str, reason: str) -> None:
    assert_refused(run_avr_robot(option, value), 2, reason)
