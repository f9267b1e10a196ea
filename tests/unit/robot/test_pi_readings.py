"""The readings of a Raspberry Pi, from copies of its files."""

from pathlib import Path

import pytest

from laser_bot_battle.msg import BoardHealth
from robot.health import BOARD_STALE, Board, health
from robot.pi_readings import PiReadings

WIRELESS = """\
Inter-| sta-|   Quality        |   Discarded packets               | Missed | WE
 face | tus | link level noise |  nwid  crypt   frag  retry   misc | beacon | 22
 wlan0: 0000   54.  -56.  -256        0      0      0      0      0        0
"""


def write(folder: Path, name: str, text: str) -> None:
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text)


@pytest.fixture
def pi(tmp_path: Path) -> PiReadings:
    write(tmp_path, "stat", "cpu  100 0 100 800 0 0 0 0 0 0\ncpu0 1 1 1 1\n")
    return PiReadings(tmp_path, tmp_path)


def test_the_load_is_that_since_the_last_question(pi: PiReadings, tmp_path: Path) -> None:
    write(tmp_path, "stat", "cpu  125 0 100 860 15 0 0 0 0 0\n")
    assert pi.cpu() == 0.25
    assert pi.cpu() == 0.0


def test_temperature_and_wifi_are_the_kernels(pi: PiReadings, tmp_path: Path) -> None:
    write(tmp_path, "class/thermal/thermal_zone0/temp", "48312\n")
    write(tmp_path, "net/wireless", WIRELESS)
    assert pi.temperature() == pytest.approx(48.312)
    assert pi.wifi() == -56


@pytest.mark.parametrize(("alarm", "low"), [("0\n", False), ("1\n", True)])
def test_under_voltage_is_the_alarm_of_rpi_volt(pi: PiReadings, tmp_path: Path, alarm: str, low: bool) -> None:
    write(tmp_path, "class/hwmon/hwmon0/name", "cpu_thermal\n")
    write(tmp_path, "class/hwmon/hwmon1/name", "rpi_volt\n")
    write(tmp_path, "class/hwmon/hwmon1/in0_lcrit_alarm", alarm)
    assert pi.under_voltage() is low


@pytest.mark.parametrize(("word", "low"), [("0\n", False), ("50005\n", True), ("50000\n", False)])
def test_without_that_driver_it_is_the_firmwares_word(pi: PiReadings, tmp_path: Path, word: str, low: bool) -> None:
    write(tmp_path, "devices/platform/soc/soc:firmware/get_throttled", word)
    assert pi.under_voltage() is low


def test_a_machine_that_tells_nothing_reads_as_nothing(tmp_path: Path) -> None:
    pi = PiReadings(tmp_path / "none", tmp_path / "none")
    assert (pi.cpu(), pi.temperature(), pi.wifi(), pi.under_voltage()) == (0.0, 0.0, 0, False)


def test_a_robot_with_the_original_sketch_has_no_board(pi: PiReadings) -> None:
    assert health(Board().latest(0.0), pi).has_board is False


def test_the_boards_words_grow_old(pi: PiReadings) -> None:
    board = Board()
    board.take(BoardHealth(supply=5012), 10.0)
    told = health(board.latest(10.0 + BOARD_STALE), pi)
    assert told.has_board
    assert told.board.supply == 5012
    assert board.latest(10.1 + BOARD_STALE) is None
