"""The virtual Uno with a boot loader: avrdude writes through the real optiboot, and every opening resets the board."""

import contextlib
import subprocess
from pathlib import Path

import pytest

from tests.support.avr import (
    CYCLES_PER_SECOND,
    FIRMWARE,
    OPTIBOOT,
    REQUEST_TOPICS,
    RESPONSE_ID,
    Arena,
    AvrRobot,
    SerialHost,
    assert_refused,
    avr_robot,
    command,
    connect,
    elf_of,
    run_avr_robot,
)
from tests.support.polling import until

# A coil of the left wheel on, if the sensor is dark; the emitter and a coil of the right wheel on; for ever.
# sbi PORTD,2; sbi DDRB,0; sbic PIND,2; sbi PORTB,0; sbi DDRD,3; sbi DDRD,4; sbi PORTD,4; rjmp .
ALL_ON = elf_of(0x9A5A, 0x9A20, 0x994A, 0x9A28, 0x9A53, 0x9A54, 0x9A5C, 0xCFFF)


def record(address: int, data: bytes, kind: int = 0) -> bytes:
    """A line of Intel HEX."""
    body = bytes([len(data)]) + address.to_bytes(2) + bytes([kind]) + data
    return b":%s\r\n" % (body + bytes([-sum(body) & 0xFF])).hex().upper().encode()


END = record(0, b"", 1)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is cut off"),
        (b"no boot loader at all\n", "is not an Intel HEX file"),
        (b":00000\n", "is not an Intel HEX file"),
        (record(0x7E00, bytes(16)).replace(b":10", b":11") + END, "is not an Intel HEX file"),
        (record(0x7E00, bytes(16), 9) + END, "is not an Intel HEX file"),
        (record(0x7E00, bytes(16)).replace(b":107E", b":107F") + END, "has a wrong checksum"),
        (record(0x7E00, bytes(16)), "is cut off"),
        (END, "does not begin with a boot section"),
        (record(0x7D00, bytes(16)) + END, "does not begin with a boot section"),
        (record(0x7FF8, bytes(16)) + END, "does not fit into the flash"),
        (record(0, b"\xff\xff", 4) + record(0xFFFF, bytes(16)) + END, "does not fit into the flash"),
        (record(0x7E00, bytes(16)) + record(0, bytes(16)) + END, "overlaps the firmware"),
    ],
    ids=[
        "empty",
        "text",
        "half a byte",
        "too short",
        "unknown record",
        "wrong checksum",
        "no end",
        "no loader",
        "at no boot section",
        "longer than its place",
        "past every address",
        "on the firmware",
    ],
)
def test_a_bad_boot_loader_is_refused(tmp_path: Path, content: bytes, reason: str) -> None:
    loader = tmp_path / "bad.hex"
    loader.write_bytes(content)
    tty = tmp_path / "tty"

    result = run_avr_robot("--firmware", FIRMWARE, "--bootloader", loader, "--name", "robot", "--serial", tty)

    assert_refused(result, 1, reason)


def start(robot: AvrRobot, host: SerialHost) -> None:
    """Ask for the topics until the program has started behind the boot loader and answers."""

    def answered() -> bool:
        host.send(REQUEST_TOPICS)
        return host.count(1) > 0

    until(answered, 10, f"TopicInfo of the subscriber; {robot.cycles_of('reset')}")


@pytest.mark.parametrize("tcp", [False, True], ids=["pty", "tcp"])
def test_avrdude_writes_another_program_through_the_boot_loader(tmp_path: Path, tcp: bool) -> None:
    firmware = tmp_path / "all_on.elf"
    firmware.write_bytes(ALL_ON)
    uart = ["--tcp", "0"] if tcp else ["--serial", tmp_path / "tty"]

    with avr_robot(*uart, "--bootloader", OPTIBOOT, firmware=firmware) as robot:
        until(lambda: robot.cycles_of("beam", "1"), 5, "the first program runs")
        port = f"net:{robot.uart}" if tcp else robot.uart
        write = f"flash:w:{FIRMWARE.with_suffix('.hex')}:i"
        avrdude = ["avrdude", "-p", "atmega328p", "-c", "arduino", "-P", port, "-b", "115200", "-D", "-U", write]
        tries = []

        def writes() -> bool:
            """An opening resets the board, whose boot loader waits for a second: a busy machine may be later."""
            tries.append(subprocess.run(avrdude, capture_output=True, text=True, timeout=60, check=False))
            return tries[-1].returncode == 0

        until(writes, 60, "avrdude writes the program")
        assert "bytes of flash verified" in tries[-1].stderr

        with contextlib.closing(connect(robot) if tcp else SerialHost(robot.uart)) as host:
            start(robot, host)
            host.send(command(1, 0))
            until(lambda: robot.position("left") == -320, 5, "the robot drives")
        assert len(robot.cycles_of("beam", "1")) == len(tries), "the first program runs no more"


def test_an_opening_resets_the_board_and_the_loader_starts_the_program_again(tmp_path: Path) -> None:
    firmware = tmp_path / "all_on.elf"
    firmware.write_bytes(ALL_ON)
    on = [["coils", "left", "on"], ["beam", "1"], ["coils", "right", "on"]]
    off = [["coils", "left", "off"], ["coils", "right", "off"], ["beam", "0"]]

    with avr_robot("--serial", tmp_path / "tty", "--bootloader", OPTIBOOT, firmware=firmware) as robot:
        until(lambda: robot.cycles_of("coils", "right", "on"), 5, "the program runs after power-on")
        with contextlib.closing(SerialHost(robot.uart)):
            until(lambda: len(robot.cycles_of("coils", "right", "on")) == 2, 10, "the program runs again")
        events = [event for event in robot.events if event.words[0] in ("reset", "coils", "beam")]

    expected = [*on, ["reset", "opened"], *off, ["reset", "watchdog"], *on]
    assert [event.words for event in events] == expected
    opened, *all_off, timeout = events[3:8]
    assert {event.cycles for event in all_off} == {opened.cycles}
    assert 1 <= (timeout.cycles - opened.cycles) / CYCLES_PER_SECOND <= 1.5


@pytest.mark.slow
def test_the_robot_works_after_every_opening(tmp_path: Path) -> None:
    with (
        contextlib.closing(Arena()) as arena,
        avr_robot("--serial", tmp_path / "tty", "--bootloader", OPTIBOOT, arena=arena.address) as robot,
    ):
        link = arena.accept()
        for number in (1, 2):
            with contextlib.closing(SerialHost(robot.uart)) as host:
                start(robot, host)
                host.send(command(1, 0))
                until(lambda number=number: robot.position("left") == -320 * number, 5, "the robot drives")
                link.send("light 1\n")
                until(lambda host=host: host.count(RESPONSE_ID), 5, "a hit")
                link.send("light 0\n")
        assert len(robot.cycles_of("reset", "opened")) == 2


@pytest.mark.slow
@pytest.mark.parametrize("loader", [[], ["--bootloader", OPTIBOOT]], ids=["without a loader", "after a reset"])
def test_shooting_costs_the_simulator_no_more_than_driving(tmp_path: Path, loader: list[str | Path]) -> None:
    with (
        avr_robot("--serial", tmp_path / "tty", *loader) as robot,
        contextlib.closing(SerialHost(robot.uart)) as host,
    ):
        start(robot, host)

        def cpu_seconds(shoot: bool) -> float:
            before = robot.cpu_seconds
            host.stream(command(1, 0, shoot), 1.5)
            return robot.cpu_seconds - before

        dark = cpu_seconds(shoot=False)
        assert cpu_seconds(shoot=True) < 2 * dark
