"""What the status LED shows while the robot's main program works, and that the program works without it."""

import itertools
import re
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot.gpio_line import CHIP
from tests.integration.robot.device import Device
from tests.integration.robot.id_service import IdService
from tests.integration.robot.web_server import WebServer
from tests.support.polling import until
from tests.support.programs import Program


@pytest.fixture
def robot(settings: dict[str, str]) -> Iterator[Program]:
    """A robot with an LED."""
    program = Program.python("tests.integration.robot.led_robot", env={**settings, "LASERBOT_LED": "17"})
    yield program
    if program.running:
        program.stop()


def changes(robot: Program) -> list[tuple[str, float]]:
    """Whether the LED went ACTIVE (lit) or INACTIVE, and when in s."""
    return [(value, float(when)) for value, when in re.findall(r"LED 17 (\w+) at (.*)\n", robot.output)]


def blinks(robot: Program, half: float) -> bool:
    """Whether the last four phases were of `half` s each, as well as a busy machine keeps time."""
    times = [when for _, when in changes(robot)[-5:]]
    phases = [end - begin for begin, end in itertools.pairwise(times)]
    return len(phases) == 4 and all(0.6 * half < phase < 1.6 * half for phase in phases)


def slowly(robot: Program) -> bool:
    return blinks(robot, 0.5)


def fast(robot: Program) -> bool:
    return blinks(robot, 0.1)


def test_it_is_lit_until_the_robot_has_an_id_then_blinks_slowly_and_is_dark_in_the_end(
    ids: IdService, robot: Program
) -> None:
    robot.wait_for("LED 17 of /dev/gpiochip0: OUTPUT, active low, ACTIVE\n")
    until(lambda: slowly(robot), 15)
    assert changes(robot)[0][0] == "INACTIVE"
    assert robot.output.index("New robot ID = 0") < robot.output.index("LED 17 INACTIVE")
    assert robot.stop(signal.SIGTERM) == 0
    assert changes(robot)[-1][0] == "INACTIVE"
    assert robot.output.count("LED released") == 1


@pytest.mark.slow
def test_it_blinks_fast_while_there_is_no_arduino(ids: IdService, device: Device, robot: Program) -> None:
    until(lambda: slowly(robot), 15)
    device.unplug()
    until(lambda: fast(robot))
    with Device(Path(device.path)):
        until(lambda: slowly(robot), 15)


@pytest.mark.slow
def test_it_blinks_fast_while_the_web_server_does_not_answer(ids: IdService, web: WebServer, robot: Program) -> None:
    until(lambda: slowly(robot), 15)
    web.stop()
    until(lambda: fast(robot))
    web.start()
    until(lambda: slowly(robot))


@pytest.mark.slow
def test_it_blinks_fast_while_the_server_has_no_id_for_the_robot(
    ids: IdService, web: WebServer, robot: Program
) -> None:
    until(lambda: slowly(robot), 15)
    ids.give("none")
    web.answer = '{"status": "ERROR"}'
    until(lambda: fast(robot))
    ids.give("0")
    web.answer = '{"status": "OK"}'
    until(lambda: slowly(robot), 15)


@pytest.mark.slow
def test_without_an_id_it_blinks_fast_from_the_first_failure_on(ids: IdService, robot: Program) -> None:
    ids.give("none")
    robot.wait_for("Service call failed")
    until(lambda: fast(robot))
    ids.give("0")
    until(lambda: slowly(robot), 15)


def test_without_gpio_one_line_says_so_and_the_robot_works(
    ids: IdService, web: WebServer, settings: dict[str, str]
) -> None:
    if Path(CHIP).exists():
        pytest.skip("the test would drive this machine's GPIO")
    lines = led_lines_of_a_working_robot(web, settings)
    assert lines == [f"no status LED: line 18 of {CHIP}: [Errno 2] No such file or directory"]


@pytest.mark.slow
def test_without_the_library_one_line_says_so_and_the_robot_works(
    ids: IdService, web: WebServer, settings: dict[str, str], tmp_path: Path
) -> None:
    (tmp_path / "gpiod.py").write_text("raise ImportError")
    lines = led_lines_of_a_working_robot(web, {**settings, "PYTHONPATH": f"{tmp_path}:{settings['PYTHONPATH']}"})
    assert lines == [
        "no status LED: the Python library gpiod, version 2, is not installed (Debian 13: python3-libgpiod)"
    ]


def led_lines_of_a_working_robot(web: WebServer, settings: dict[str, str]) -> list[str]:
    """What the log says about the LED."""
    robot = Program.python("robot.id_service_client", env={**settings, "LASERBOT_LED": "18"})
    try:
        robot.wait_for("/Robot0/command")
        until(lambda: len(web.pings) >= 3)
        assert robot.stop() == 0
    finally:
        robot.kill()
    return re.findall(" INFO robot.status_led: (.*)", robot.output)
