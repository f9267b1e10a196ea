"""The virtual Uno as a program: its command line, its serial port on a pty or on TCP, and its link to the arena."""

import contextlib
import signal
import socket
import struct
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from tests.support.avr import (
    AVR_ROBOT,
    CYCLES_PER_SECOND,
    FIRMWARE,
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
from tests.support.ports import free_port


@pytest.fixture
def arena() -> Iterator[Arena]:
    arena = Arena()
    with contextlib.closing(arena):
        yield arena


# ---- command line ----------------------------------------------------------------------------------------------------


def test_help_explains_the_options_and_ends_well() -> None:
    result = run_avr_robot("--help")

    assert result.returncode == 0
    assert result.stdout.startswith("usage: avr_robot")
    assert result.stderr == ""


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ([], "--firmware is missing"),
        (["--fly"], "--fly"),
        (["--firmware"], "needs a value"),
        (["extra"], "extra"),
        (["--firmware", "/nonexistent.elf"], "/nonexistent.elf"),
        (["--firmware", FIRMWARE], "--name is missing"),
        (["--firmware", FIRMWARE, "--bootloader", "/nonexistent.hex"], "/nonexistent.hex"),
        (["--firmware", FIRMWARE, "--name", "two words"], "two words"),
        (["--firmware", FIRMWARE, "--name", "x" * 33], "x" * 33),
        (["--firmware", FIRMWARE, "--name", ""], "--name"),
        (["--firmware", FIRMWARE, "--name", "robot"], "--serial or --tcp"),
        (["--firmware", FIRMWARE, "--name", "robot", "--serial", "tty", "--tcp", "5555"], "--serial or --tcp"),
        (["--tcp", "no-port"], "no-port"),
        (["--tcp", "70000"], "70000"),
        (["--tcp", ":5555"], ":5555"),
        (["--arena", "8081"], "HOST:PORT"),
        (["--arena", "localhost:"], "localhost:"),
    ],
)
def test_a_wrong_command_line_is_refused_with_one_clear_line(arguments: list[str | Path], reason: str) -> None:
    assert_refused(run_avr_robot(*arguments), 2, reason)


@pytest.mark.parametrize("address", ["127.0.0.1", "::1"])
def test_a_tcp_port_in_use_is_refused(address: str) -> None:
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    with socket.create_server((address, 0), family=family) as taken:
        port = taken.getsockname()[1]
        result = run_avr_robot("--firmware", FIRMWARE, "--name", "robot", "--tcp", str(port))

    assert_refused(result, 2, f"127.0.0.1:{port}")


def test_a_file_in_place_of_the_serial_link_is_left_alone(tmp_path: Path) -> None:
    file = tmp_path / "tty"
    file.write_text("precious")

    assert_refused(run_avr_robot("--firmware", FIRMWARE, "--name", "robot", "--serial", file), 2, str(file))
    assert file.read_text() == "precious"


def test_a_serial_link_in_a_missing_folder_is_refused(tmp_path: Path) -> None:
    link = tmp_path / "missing" / "tty"

    assert_refused(run_avr_robot("--firmware", FIRMWARE, "--name", "robot", "--serial", link), 2, str(link))


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is not an ELF file"),
        (b"no firmware at all", "is not an ELF file"),
        (elf_of(0xCFFF)[:60], "has no program in it"),
        (elf_of(0xCFFF)[:-2], "is cut off"),
        (elf_of(*[0] * 16385), "does not fit"),
        (elf_of(), "has no program in it"),
    ],
    ids=["empty", "text", "half a header", "half a program", "too big", "no program"],
)
def test_a_bad_firmware_file_is_refused(tmp_path: Path, content: bytes, reason: str) -> None:
    firmware = tmp_path / "bad.elf"
    firmware.write_bytes(content)

    assert_refused(run_avr_robot("--firmware", firmware, "--name", "robot", "--serial", tmp_path / "tty"), 1, reason)


def test_a_program_for_another_processor_is_refused(tmp_path: Path) -> None:
    assert_refused(
        run_avr_robot("--firmware", AVR_ROBOT, "--name", "robot", "--serial", tmp_path / "tty"),
        1,
        "is not a program for an AVR",
    )


@pytest.mark.parametrize(
    ("instructions", "reason"),
    [
        pytest.param([0x0000], "has crashed", id="runs off the end of the flash"),
        pytest.param([0xE001, 0xBF03, 0x94F8, 0x9588], "sleep for ever", id="sleeps with interrupts off"),
    ],
)
def test_a_firmware_that_ends_is_reported_and_ends_the_robot(
    tmp_path: Path, instructions: list[int], reason: str
) -> None:
    firmware = tmp_path / "ending.elf"
    firmware.write_bytes(elf_of(*instructions))
    link = tmp_path / "tty"

    result = run_avr_robot("--firmware", firmware, "--name", "robot", "--serial", link)

    assert result.returncode == 1
    assert reason in result.stderr
    assert not link.is_symlink()


# ---- serial port -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sig", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly_and_removes_the_link(tmp_path: Path, sig: signal.Signals) -> None:
    with avr_robot("--serial", tmp_path / "tty") as robot:
        assert robot.uart == str(tmp_path / "tty")
        assert (tmp_path / "tty").readlink().is_char_device()
        assert robot.program.stop(sig, seconds=0.5) == 0

    assert list(tmp_path.iterdir()) == []


def test_a_stale_link_is_replaced_and_the_newest_owner_keeps_it(tmp_path: Path) -> None:
    link = tmp_path / "tty"
    link.symlink_to("/dev/pts/nonexistent")

    with avr_robot("--serial", link) as older:
        first = link.readlink()
        with avr_robot("--serial", link):
            second = link.readlink()
            older.stop()
            assert link.readlink() == second != first


def test_the_serial_port_works_again_for_the_next_program_that_opens_it(tmp_path: Path) -> None:
    with avr_robot("--serial", tmp_path / "tty") as robot:
        for _ in range(3):
            with contextlib.closing(SerialHost(robot.uart)) as host:
                host.negotiate()
        assert robot.cycles_of("reset") == []


def test_two_robots_run_at_once_and_apart(tmp_path: Path) -> None:
    with (
        avr_robot("--serial", tmp_path / "tty0", name="virtual0") as mover,
        avr_robot("--serial", tmp_path / "tty1", name="virtual1") as other,
        contextlib.closing(SerialHost(mover.uart)) as host,
    ):
        host.send(command(1, 0))
        until(lambda: mover.position("left") == -320, 5, "the first robot drives")
        assert other.cycles_of("coil") == []


def test_a_robot_to_which_nothing_happens_wakes_its_computer_half_as_often(tmp_path: Path) -> None:
    with avr_robot("--serial", tmp_path / "tty") as robot:
        robot.let_pass(0.5)  # the firmware tells its topics first
        process = psutil.Process(robot.program.process.pid)
        start, before = robot.now, process.num_ctx_switches().voluntary
        robot.let_pass(1.0)
        slices = 1000 * (robot.now - start) / CYCLES_PER_SECOND
        assert process.num_ctx_switches().voluntary - before < 0.7 * slices


@pytest.mark.slow
def test_time_runs_at_the_pace_of_the_clock(tmp_path: Path) -> None:
    with avr_robot("--serial", tmp_path / "tty") as robot, contextlib.closing(SerialHost(robot.uart)) as host:
        host.stream(command(0, -1), 1.0)
        robot.wait_until_still()
        first, *_, last = [event for event in robot.events if event.words[0] == "coil"]

        simulated = (last.cycles - first.cycles) / CYCLES_PER_SECOND
        assert simulated == pytest.approx((last.ns - first.ns) / 1e9, abs=0.1)


def test_a_suspended_robot_does_not_race_through_the_time_it_missed(tmp_path: Path) -> None:
    with avr_robot("--serial", tmp_path / "tty") as robot:
        robot.program.process.send_signal(signal.SIGSTOP)
        stopped = time.monotonic_ns()
        until(lambda: time.monotonic_ns() - stopped > 10**9, 5)
        robot.program.process.send_signal(signal.SIGCONT)
        resumed = time.monotonic_ns()
        until(lambda: robot.events[-1].ns - resumed > 0.3 * 10**9, 5, "life after the pause")

        lived = robot.now / CYCLES_PER_SECOND
        assert lived < (robot.events[-1].ns - robot.events[0].ns) / 1e9 - 0.8


def test_the_serial_line_is_as_slow_as_a_real_one(tmp_path: Path) -> None:
    with avr_robot("--serial", tmp_path / "tty") as robot, contextlib.closing(SerialHost(robot.uart)) as host:
        mark = robot.mark()
        host.negotiate()
        first, *later = [event for event in robot.events[mark:] if event.words[0] == "uart-out"]
        sent = sum(int(event.words[1]) for event in later)
        seconds = (later[-1].cycles - first.cycles) / CYCLES_PER_SECOND

        assert sent / seconds == pytest.approx(16e6 / 16 / 17 / 10, rel=0.06)  # 58824 baud, 10 bits a byte


@contextlib.contextmanager
def tcp_robot(at: str = "0") -> Iterator[AvrRobot]:
    with avr_robot("--tcp", at) as robot:
        yield robot


def test_the_serial_port_on_tcp_speaks_the_same(tmp_path: Path) -> None:
    port = free_port()
    with tcp_robot(f"localhost:{port}") as robot:
        assert robot.uart == f"localhost:{port}"
        with contextlib.closing(connect(robot)) as host:
            host.negotiate()
            host.send(command(0, 1))
            until(lambda: robot.position("left") == -320, 5, "the robot turns")


@pytest.mark.parametrize("at", ["0", "localhost:0", "0.0.0.0:0", "[::1]:0"])
def test_a_tcp_client_of_localhost_may_try_either_of_its_addresses(at: str) -> None:
    with tcp_robot(at) as robot:
        port = robot.uart.rpartition(":")[2]
        for address in ("[::1]", "127.0.0.1"):
            with contextlib.closing(SerialHost(f"socket://{address}:{port}")) as host:
                host.negotiate()


def test_a_new_tcp_client_replaces_the_old_one() -> None:
    with tcp_robot() as robot:
        host, port = robot.uart.split(":")
        with socket.create_connection((host, int(port)), 5) as old, contextlib.closing(connect(robot)) as new:
            new.negotiate()
            old.settimeout(5)
            assert old.recv(1) == b""  # closed by the robot
            new.send(command(1, 0))
            until(lambda: robot.position("left") == -320, 5, "the new client drives")


def test_tcp_clients_come_and_go_even_rudely() -> None:
    with tcp_robot() as robot:
        host, port = robot.uart.split(":")
        for _ in range(3):
            rude = socket.create_connection((host, int(port)), 5)
            rude.sendall(command(1, 0)[:5])
            rude.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            rude.close()  # reset instead of goodbye
        with contextlib.closing(connect(robot)) as client:
            client.negotiate()


# ---- arena link ------------------------------------------------------------------------------------------------------


def test_the_arena_hears_name_wheels_and_beam_first_and_then_every_change(tmp_path: Path, arena: Arena) -> None:
    with (
        avr_robot("--serial", tmp_path / "tty", name="Robot-7_b", arena=arena.address) as robot,
        contextlib.closing(SerialHost(robot.uart)) as host,
    ):
        link = arena.accept()
        assert link.hello() == ["robot Robot-7_b", "wheels 0 0", "beam 0"]
        began = time.monotonic()
        host.send(command(1, 0, shoot=True))
        link.wait_for("wheels -320 320")
        seconds = time.monotonic() - began
        link.wait_for("beam 0")
        until(lambda: link.lines[-1] == "beam 0", 5, "the end of the shot")

        left = [int(line.split()[1]) for line in link.lines if line.startswith("wheels")]
        assert left == sorted(left, reverse=True)
        assert 10 <= len(left) <= 2 + seconds / 0.01  # at most every 10 ms
        assert [line for line in link.lines if line.startswith("beam")] == ["beam 0", "beam 1", "beam 0"]


def test_a_restarted_arena_gets_the_present_state(tmp_path: Path, arena: Arena) -> None:
    with (
        avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot,
        contextlib.closing(SerialHost(robot.uart)) as host,
    ):
        arena.accept().hello()
        host.send(command(0, -1))
        robot.wait_until_still()
        until(lambda: robot.position("right") == 320, 5, "the robot turns")
        arena.close()
        with contextlib.closing(Arena(arena.port)) as restarted:
            link = restarted.accept()
            assert link.hello() == ["robot virtual0", "wheels 320 320", "beam 0"]
            link.send("light 1\n")
            until(lambda: robot.cycles_of("light", "1"), 5, "light by the restarted arena")


def test_a_robot_whose_arena_vanishes_is_in_the_dark_and_keeps_driving(tmp_path: Path, arena: Arena) -> None:
    with (
        avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot,
        contextlib.closing(SerialHost(robot.uart)) as host,
    ):
        arena.accept().send("light 1\n")
        until(lambda: robot.cycles_of("light", "1"), 5, "light")
        arena.close()
        until(lambda: robot.cycles_of("light", "0"), 5, "darkness")
        host.send(command(1, 0))
        until(lambda: robot.position("left") == -320, 5, "the robot drives")


@pytest.mark.parametrize("address", ["127.0.0.1:1", "no-such-arena.invalid:8081"])
def test_a_robot_without_arena_drives_says_so_once_and_ends_at_once(tmp_path: Path, address: str) -> None:
    with (
        avr_robot("--serial", tmp_path / "tty", arena=address) as robot,
        contextlib.closing(SerialHost(robot.uart)) as host,
    ):
        robot.program.wait_for(f"no arena at {address}", 15)
        host.send(command(1, 0))
        until(lambda: robot.position("left") == -320, 5, "the robot drives")
        assert robot.program.stop(seconds=0.5) == 0
        assert robot.program.output.count("no arena at") == 1


def test_an_error_of_the_arena_is_told_and_the_robot_tries_again(tmp_path: Path, arena: Arena) -> None:
    with avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot:
        link = arena.accept()
        link.hello()
        link.send("error another robot has this name\n")
        link.close()
        robot.program.wait_for("the arena says: another robot has this name")
        assert arena.accept().hello()[0] == "robot virtual0"


def test_nonsense_from_the_arena_does_nothing(tmp_path: Path, arena: Arena) -> None:
    with avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot:
        link = arena.accept()
        link.send("light\nlight 2\nwheels 1 1\n\nlig")
        link.send("ht 1\n")
        until(lambda: robot.cycles_of("light", "1"), 5, "the one good line")
        assert [event.words for event in robot.events if event.words[0] == "light"] == [["light", "1"]]
        link.send("x" * 1000)  # this is not an arena: the robot hangs up and comes again
        until(lambda: link.lines and link.closed, 5, "the end of the connection")
        assert arena.accept().hello()[0] == "robot virtual0"
        until(lambda: robot.cycles_of("light", "0"), 5, "darkness")
