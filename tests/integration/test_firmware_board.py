"""The real firmware in the simulated Uno, in virtual time: how it says it is, and how it comes back after a fault."""

import itertools
import random
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from laser_bot_battle.msg import BoardHealth
from tests.support.avr import FIRMWARE, OPTIBOOT, REQUEST_TOPICS, RESPONSE_ID, command, frame
from tests.support.documents import page, table
from tests.support.programs import ROOT
from tests.support.virtual_time import (
    BOARD_ID,
    CODED,
    HIT_ID,
    IDENTIFY_ID,
    MS,
    PLAIN,
    Uno,
    lengths,
    setup,
    uno,
)

PACKETS = {
    int(row["shooter"]): [int(us) for us in row["light"].split()] for row in table(page("protocol-light.md"), "Packets")
}
OLD_BOOTLOADER = Path("/usr/share/arduino/hardware/arduino/avr/bootloaders/atmega/ATmegaBOOT_168_atmega328.hex")
POWER_ON, RESET_PIN, WATCHDOG = 1, 2, 8
RAM = range(0x100, 0x900)
LED_PORT, LED = 0x25, 1 << 5
UCSR0A, U2X, UBRR0L = 0xC0, 1 << 1, 0xC4
RESPONSE_INFO = b"\x7d\x00"


@pytest.fixture
def robot() -> Iterator[Uno]:
    with uno() as robot:
        robot.run(0.02)
        robot.connect(setup(5, 2, CODED, damage=3))
        yield robot


def health(robot: Uno) -> BoardHealth:
    """The last one."""
    message = BoardHealth()
    message.deserialize(robot.said(BOARD_ID)[-1][1])
    return message


def crc16(data: bytes) -> int:
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc


def times_told(robot: Uno) -> int:
    """How often it has told its topics."""
    return sum(payload.startswith(RESPONSE_INFO) for _, payload in robot.said(0))


# ---- health ----------------------------------------------------------------------------------------------------------


def test_health_comes_once_a_second_while_connected() -> None:
    with uno() as robot:
        robot.run(2.5)
        assert robot.said(BOARD_ID) == []
        robot.connect()
        robot.run(5.5)
        times = [cycle / MS for cycle, _ in robot.said(BOARD_ID)]
        assert len(times) == 5
        assert times[-1] - times[0] == pytest.approx(4000, rel=0.01)


def test_health_says_how_the_board_is(robot: Uno, tmp_path: Path) -> None:
    robot.send(command(0, 0, shoot=True))
    robot.run(0.2)
    robot.light(PACKETS[42])
    robot.run(0.1)
    robot.light(PACKETS[42][:9])
    robot.send(b"\x00\x01" + command(0, 0)[:-1] + b"\x00")
    robot.run(2.0)
    last = health(robot)
    subprocess.run(["avr-objcopy", "-O", "binary", "-R", ".eeprom", FIRMWARE, tmp_path / "flash"], check=True)

    assert (last.major, last.mode, last.deaf) == (2, CODED, False)
    assert last.hash == crc16((tmp_path / "flash").read_bytes())
    assert last.reset_cause == POWER_ON
    assert last.uptime == 2
    assert last.supply == pytest.approx(5000, rel=0.01)
    assert last.battery == pytest.approx(6000, rel=0.01)  # 2 V on A0
    assert 50 <= last.loop_max < 5000
    assert 2000 < last.round_trip < 20000
    assert (last.serial_errors, last.overruns) == (1, 0)
    assert last.resyncs >= 1
    assert (last.packets, last.bad_packets, last.shots) == (1, 1, 1)


def test_a_robot_with_the_sun_on_its_sensor_says_that_it_is_deaf() -> None:
    with uno(coded=False) as robot:
        robot.run(0.02)
        robot.connect()
        robot.run(1.1)
        assert (health(robot).deaf, health(robot).mode) == (False, PLAIN)
        robot.shine(True)
        robot.run(4)
        assert health(robot).deaf
        robot.shine(False)
        robot.run(1.1)
        assert not health(robot).deaf


def test_a_host_that_does_not_know_the_health_message_gets_no_more_of_them(robot: Uno) -> None:
    """As upstream's rosserial_python, which asks for the topics again."""
    answered = 0
    for _ in range(100):
        robot.run(0.05)
        if len(robot.said(BOARD_ID)) > answered:
            answered += 1
            robot.send(REQUEST_TOPICS)
    assert answered == 2


# ---- line ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("board", "baud"), [("uno", 58824), ("nano", 57143)])
def test_the_line_has_the_speed_of_the_boards_bridge(tmp_path: Path, board: str, baud: int) -> None:
    built = tmp_path / "firmware"
    make = ["make", "-s", "-C", "firmware", f"BUILD={built}", f"BOARD={board}"]
    subprocess.run(make, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    with uno(built / "laserbot.elf") as robot:
        robot.run(0.02)
        robot.connect()
        assert times_told(robot) == 2  # when it started, and when asked
        samples = 8 if robot.peek(UCSR0A) & U2X else 16
        assert 16_000_000 / samples / (robot.peek(UBRR0L) + 1) == pytest.approx(baud, abs=1)


# ---- identify --------------------------------------------------------------------------------------------------------


def led_changes(robot: Uno, seconds: float) -> list[int]:
    """The LED's state each 25 ms."""
    states = []
    for _ in range(int(seconds / 0.025)):
        robot.run(0.025)
        states.append(robot.peek(LED_PORT) & LED)
    return states


def test_identify_wiggles_and_flashes_for_2_s(robot: Uno) -> None:
    start = robot.now
    robot.send(frame(IDENTIFY_ID))
    states = led_changes(robot, 2.5)
    assert len([1 for before, after in itertools.pairwise(states) if before != after]) >= 7
    assert states[-1] == 0
    assert max(abs(left) for _, left, _ in robot.steps) > 100
    assert all(left == right for _, left, right in robot.steps)  # it turns in place
    assert abs(robot.position("left")) < 20
    assert robot.steps[-1][0] - start <= 2050 * MS


def test_identify_leaves_the_wheels_to_the_player(robot: Uno) -> None:
    robot.run(0.2, command(0, 0))
    robot.send(frame(IDENTIFY_ID))
    robot.run(0.1)
    assert robot.peek(LED_PORT) & LED
    robot.run(2.2)
    assert robot.steps == []


def test_a_command_ends_the_wiggling_at_once(robot: Uno) -> None:
    robot.send(frame(IDENTIFY_ID))
    robot.run(0.4)
    robot.send(command(0, 0))
    robot.run(0.01)
    place = robot.position("left")
    robot.run(2.5)
    assert robot.position("left") == place


# ---- sleep -----------------------------------------------------------------------------------------------------------


def test_a_robot_that_stands_sleeps_most_of_the_time(robot: Uno) -> None:
    """A battery and a virtual robot's computer pay for the rest: some 8 % while it stands, 22 % while it drives."""
    robot.run(1.0)
    assert robot.awake(0.2) < 0.12
    robot.run(0.2, command(1, 0))
    assert robot.awake(0.02) < 0.3


def test_a_command_to_a_robot_that_stands_turns_the_wheels_as_soon_as_it_is_read(robot: Uno) -> None:
    """Ticks that a standing robot leaves out are there again at once."""
    for number in range(20):
        robot.run(0.45 + number * 0.00031)
        start = robot.now
        robot.send(command(1, 0))
        robot.run(0.01)
        first = min(cycle for cycle, *_ in robot.steps if cycle > start)
        assert first - start <= 2.75 * MS  # 11 bytes on the line take 1.9 ms


# ---- faults ----------------------------------------------------------------------------------------------------------


def faults(robot: Uno) -> list[str]:
    """What the robot does not do as it should: drive, shoot, see light, say how it is."""
    wrong = []
    start, place = robot.now, robot.position("left")
    robot.send(command(1, 0, shoot=True))
    robot.run(0.6)
    if robot.position("left") != pytest.approx(place - 320, abs=3):
        wrong.append("wheels")
    shot = lengths([cycle for cycle in robot.carrier if cycle > start])
    if shot != pytest.approx(PACKETS[5], abs=100):
        wrong.append("shot")
    robot.light(PACKETS[42])
    robot.run(0.1)
    if [payload for _, payload in robot.said(HIT_ID, start)] != [b"\x2a\x01\x09"]:
        wrong.append("hit")
    robot.run(1.1)
    if not robot.said(BOARD_ID, start):
        wrong.append("health")
    return wrong


@pytest.mark.parametrize("bootloader", [None, OPTIBOOT, OLD_BOOTLOADER], ids=["none", "optiboot", "old"])
def test_a_program_that_hangs_starts_again_and_has_its_setup_back(bootloader: Path | None) -> None:
    with uno(bootloader=bootloader) as robot:
        robot.run(3.0)  # a boot loader waits for a new program first
        robot.connect(setup(5, 2, CODED, damage=3))
        told = times_told(robot)
        robot.run(0.2, command(1, 0))
        hung = robot.now
        robot.hang()
        robot.run(1.0)
        assert times_told(robot) == told + 1
        assert robot.steps[-1][0] - hung <= 350 * MS
        assert faults(robot) == []
        assert health(robot).reset_cause & WATCHDOG


@pytest.mark.parametrize("bootloader", [None, OPTIBOOT], ids=["none", "optiboot"])
def test_a_robot_whose_reset_button_was_pressed_has_its_setup_back_at_once(bootloader: Path | None) -> None:
    with uno(bootloader=bootloader) as robot:
        robot.run(3.0)
        robot.connect(setup(5, 2, CODED, damage=3))
        told = times_told(robot)
        robot.run(0.2, command(1, 0))
        robot.reset()
        robot.run(1.3 if bootloader else 0.3)  # the boot loader waits for a new program for a second
        assert times_told(robot) == told + 1
        assert faults(robot) == []
        assert health(robot).reset_cause == RESET_PIN


def test_light_that_came_in_coded_mode_is_no_hit_when_the_mode_is_plain_again() -> None:
    with uno(coded=False) as robot:
        robot.run(0.02)
        robot.connect(setup(5, mode=PLAIN))
        robot.run(0.2)
        robot.send(setup(5, mode=CODED))
        robot.run(0.1)
        robot.shine(True)
        robot.run(1.0)
        robot.send(setup(5, mode=PLAIN))
        robot.run(0.5)
        assert robot.said(RESPONSE_ID) == []
        robot.shine(False)
        robot.run(0.1)
        robot.shine(True)
        robot.run(0.1)
        assert len(robot.said(RESPONSE_ID)) == 1


@pytest.mark.slow
def test_a_robot_whose_ram_was_disturbed_comes_back_by_itself() -> None:
    """Any bit of it, at any time while it drives; see also the firmware's own stack at the end of the RAM."""
    chance = random.Random(18)
    for _ in range(60):
        address, bit, wait = chance.choice(RAM), chance.randrange(8), 0.2 + 0.3 * chance.random()
        with uno() as robot:
            robot.run(0.02)
            robot.connect(setup(5, 2, CODED, damage=3))
            robot.run(wait, command(1, 0))
            robot.flip(address, bit)
            robot.run(1.0, command(1, 0))
            robot.run(0.5)
            assert faults(robot) == [], f"bit {bit} of {address:#x}"


@pytest.mark.parametrize("register", [0x6F, 0x80, 0x81, 0xC1, 0x69, 0x2A, 0x24, 0xB1])
def test_a_register_that_was_disturbed_is_noticed(robot: Uno, register: int) -> None:
    """TIMSK1, TCCR1A, TCCR1B, UCSR0B, EICRA, DDRD, DDRB, TCCR2B."""
    told = times_told(robot)
    robot.flip(register, 3)
    robot.run(0.8)
    assert times_told(robot) == told + 1
    assert faults(robot) == []
