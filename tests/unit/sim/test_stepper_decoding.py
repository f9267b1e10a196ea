"""How the virtual motors read their coils (sim/avr_robot/stepper.c): what a good firmware never shows."""

import ctypes
import subprocess
from pathlib import Path

import pytest

from tests.support.programs import ROOT

STILL, STEP, SLIP, ENERGISED, RELEASED = range(5)
PHASES = [0b0001, 0b0011, 0b0010, 0b0110, 0b0100, 0b1100, 0b1000, 0b1001]


class Stepper(ctypes.Structure):
    _fields_ = [("position", ctypes.c_int64), ("phase", ctypes.c_int), ("pattern", ctypes.c_uint8)]


class Motor:
    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library
        self._stepper = Stepper()
        library.stepper_init(ctypes.byref(self._stepper))

    def coils(self, pattern: int) -> int:
        """Switch the coils; returns what the motor does."""
        return int(self._library.stepper_update(ctypes.byref(self._stepper), ctypes.c_uint8(pattern)))

    @property
    def position(self) -> int:
        return int(self._stepper.position)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    shared = tmp_path_factory.mktemp("stepper") / "stepper.so"
    source: Path = ROOT / "sim/avr_robot/stepper.c"
    subprocess.run(["cc", "-std=c11", "-shared", "-fPIC", "-o", shared, source], check=True)
    return ctypes.CDLL(str(shared))


@pytest.fixture
def motor(library: ctypes.CDLL) -> Motor:
    """With current in the phase where it stands."""
    motor = Motor(library)
    assert motor.coils(PHASES[0]) == ENERGISED
    return motor


def test_the_eight_phases_in_order_are_a_turn_forward_and_in_reverse_a_turn_back(motor: Motor) -> None:
    assert [motor.coils(pattern) for pattern in [*PHASES[1:], PHASES[0]]] == [STEP] * 8
    assert motor.position == 8
    assert [motor.coils(pattern) for pattern in reversed(PHASES)] == [STEP] * 8
    assert motor.position == 0


def test_the_same_coils_again_change_nothing(motor: Motor) -> None:
    assert motor.coils(PHASES[0]) == STILL
    assert motor.position == 0


@pytest.mark.parametrize("jump", [2, 3, 4, 5, 6])
def test_a_jump_over_phases_is_a_slip_and_the_motor_goes_on_from_there(motor: Motor, jump: int) -> None:
    assert motor.coils(PHASES[jump]) == SLIP
    assert motor.position == 0
    assert motor.coils(PHASES[jump + 1]) == STEP
    assert motor.position == 1


def test_a_pattern_that_is_no_phase_is_a_slip_and_so_is_the_way_out(motor: Motor) -> None:
    assert motor.coils(0b0101) == SLIP
    assert motor.coils(PHASES[1]) == SLIP
    assert motor.position == 0
    assert motor.coils(PHASES[2]) == STEP
    assert motor.position == 1


def test_a_motor_without_current_keeps_its_place(motor: Motor) -> None:
    motor.coils(PHASES[1])
    assert motor.coils(0) == RELEASED
    assert motor.coils(PHASES[1]) == ENERGISED
    assert motor.coils(0) == RELEASED
    assert motor.coils(PHASES[2]) == STEP
    assert motor.position == 2


def test_only_the_low_four_bits_are_coils(motor: Motor) -> None:
    assert motor.coils(0xF0 | PHASES[1]) == STEP
