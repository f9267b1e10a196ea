"""The robot's main program between a device, a real ROS service and a real HTTP server."""

import hashlib
import itertools
import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from laser_bot_battle.backoff import STEADY
from tests.integration.robot.device import Device
from tests.integration.robot.id_service import IdService
from tests.integration.robot.web_server import WebServer
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.processes import command_line, descendants
from tests.support.programs import Program
from tests.support.ros import RosMaster


@pytest.fixture
def robot(settings: dict[str, str]) -> Iterator[Program]:
    """The program under test."""
    program = Program.python("robot.id_service_client", env=settings)
    yield program
    if program.running:
        program.stop()


def started(program: Program, word: str) -> list[int]:
    """Process IDs of running programs that `program` has started, by a word of their command line."""
    return [one.pid for one in descendants(program.process.pid) if word in command_line(one)]


def serial_node(program: Program, robot_id: int) -> int:
    """The process ID of the serial node, once there is one."""
    return until(lambda: started(program, f"__name:=Robot{robot_id}"), 15)[0]


def worker(program: Program) -> int:
    """The process that `program` keeps going."""
    (pid,) = [one.pid for one in psutil.Process(program.process.pid).children()]
    return int(pid)


def has_ended(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


def test_a_robot_registers_once_its_arduino_answers_and_pings_with_its_id(
    ids: IdService, web: WebServer, device: Device, robot: Program
) -> None:
    robot.wait_for(" INFO robot.id_service_client: New robot ID = 0\n")
    robot.wait_for("/Robot0/command")
    until(lambda: len(web.pings) >= 3)
    (ping,) = {body for _, _, body in web.pings}
    robot_id, _, key = ping.partition("&key=")
    assert robot_id == "ID=0"
    assert len(key) >= 43
    assert ids.callers == ["/id_service_client_test_robot_1"]
    assert ids.keys == [hashlib.sha256(key.encode()).hexdigest()]


@pytest.mark.slow
def test_every_start_has_a_key_of_its_own(ids: IdService, web: WebServer, robot: Program, settings) -> None:
    robot.wait_for("New robot ID = 0")
    robot.stop()
    again = Program.python("robot.id_service_client", env=settings)
    try:
        again.wait_for("New robot ID = 0")
    finally:
        again.stop()
    assert len(set(ids.keys)) == 2


@pytest.mark.slow
def test_the_sign_of_life_is_renewed_while_the_robot_works_and_only_then(
    ids: IdService, web: WebServer, settings: dict[str, str], robot: Program
) -> None:
    alive = Path(settings["LASERBOT_ALIVE_FILE"])

    def age() -> float:
        return time.time() - alive.stat().st_mtime

    ids.give("none")
    robot.wait_for("no ID is free")
    assert not alive.exists()
    ids.give("0")
    until(alive.exists, 15)
    first = alive.stat().st_mtime
    until(lambda: alive.stat().st_mtime > first + 2)
    web.stop()
    until(lambda: age() > 3)
    web.start()
    until(lambda: age() < 1)


@pytest.mark.slow
def test_a_robot_whose_arduino_does_not_answer_is_not_registered(
    ids: IdService, web: WebServer, device: Device, robot: Program
) -> None:
    device.answers = False
    robot.wait_for("no answer to the topic request for 8 s (nothing came at all")
    robot.wait_for("the next attempt may reset it, and gives it 30 s")
    assert ids.callers == []
    assert web.pings == []
    device.answers = True
    robot.wait_for("New robot ID = 0")


def test_a_server_that_forgot_the_robot_is_asked_again_and_the_serial_node_starts_anew(
    ids: IdService, web: WebServer, robot: Program
) -> None:
    node = serial_node(robot, 0)
    robot.wait_for("/Robot0/command")
    web.answer = '{"status": "ERROR"}'
    until(lambda: len(ids.callers) == 2)
    assert serial_node(robot, 0) != node, "registered first, it would be offered before it can move"
    web.answer = '{"status": "OK"}'
    until(lambda: robot.output.count("New robot ID = 0") == 2)
    until(lambda: robot.output.count("/Robot0/command") == 2, 15)
    pings = len(web.pings)
    until(lambda: len(web.pings) > pings + 3)


@pytest.mark.slow
def test_a_new_id_starts_the_serial_node_under_the_new_name(ids: IdService, web: WebServer, robot: Program) -> None:
    robot.wait_for("/Robot0/command")
    ids.give("5")
    web.answer = '{"status": "ERROR"}'
    robot.wait_for("New robot ID = 5")
    web.answer = '{"status": "OK"}'
    robot.wait_for("/Robot5/command")
    assert started(robot, "__name:=Robot0") == []
    until(lambda: web.pings[-1][2].startswith("ID=5&"))


@pytest.mark.slow
def test_a_serial_node_that_has_worked_is_started_again_while_the_pings_go_on(
    ids: IdService, web: WebServer, robot: Program
) -> None:
    robot.wait_for("/Robot0/command")
    node = serial_node(robot, 0)
    steady = time.monotonic() + STEADY
    until(lambda: time.monotonic() > steady, STEADY + 1, "it has not failed at its start")
    os.kill(node, signal.SIGKILL)
    killed = time.monotonic()
    until(lambda: robot.output.count("/Robot0/command") == 2, 5)
    assert serial_node(robot, 0) != node
    assert len(ids.callers) == 1
    moments = [moment for moment, _, _ in web.pings]
    pauses = [later - earlier for earlier, later in itertools.pairwise(moments) if later > killed]
    assert max(pauses) < 1.5, "silent for 2 s, a robot is out of its battle"


@pytest.mark.slow
def test_pings_stop_when_the_device_does_not_answer_after_the_serial_node_was_started_again(
    ids: IdService, web: WebServer, device: Device, robot: Program
) -> None:
    robot.wait_for("/Robot0/command")
    steady = time.monotonic() + STEADY
    until(lambda: time.monotonic() > steady, STEADY + 1, "it has not failed at its start")
    device.answers = False
    os.kill(serial_node(robot, 0), signal.SIGKILL)
    robot.wait_for("no answer to the topic request within 8 s")
    robot.wait_for("Connection to Arduino lost: the serial node ended with exit code 3 (again in")
    pings, asked = len(web.pings), device.topic_requests
    until(lambda: device.topic_requests >= asked + 2)
    assert len(web.pings) <= pings + 1  # one may have been on its way
    device.answers = True
    until(lambda: robot.output.count("New robot ID = 0") == 2)


def test_a_killed_worker_is_back_at_once(ids: IdService, web: WebServer, robot: Program) -> None:
    robot.wait_for("/Robot0/command")
    first = worker(robot)
    os.kill(first, signal.SIGKILL)
    robot.wait_for("the program was ended by signal 9: it is started again in 0.2 s")
    until(lambda: robot.output.count("New robot ID = 0") == 2, 5)
    assert worker(robot) != first
    assert robot.running


@pytest.mark.slow
def test_a_worker_that_hangs_is_killed_and_back(ids: IdService, web: WebServer, robot: Program) -> None:
    robot.wait_for("/Robot0/command")
    until(lambda: len(web.pings) >= 3)
    os.kill(worker(robot), signal.SIGSTOP)
    robot.wait_for("the program hangs: no sign of life for 5 s", 8)
    until(lambda: robot.output.count("New robot ID = 0") == 2, 5)


@pytest.mark.slow
def test_pings_stop_when_the_serial_node_ends_at_its_start_and_the_robot_comes_back(
    ids: IdService, web: WebServer, robot: Program
) -> None:
    robot.wait_for("/Robot0/command")
    ids.give("none")
    os.kill(serial_node(robot, 0), signal.SIGKILL)
    robot.wait_for("Connection to Arduino lost: the serial node ended with exit code -9")
    pings = len(web.pings)
    robot.wait_for("Service call failed")
    assert "no ID is free" in robot.output
    assert len(web.pings) <= pings + 1  # one may have been on its way
    ids.give("0")
    until(lambda: robot.output.count("New robot ID = 0") == 2)
    until(lambda: len(web.pings) > pings + 3)


def test_an_unplugged_arduino_ends_the_pings_and_a_plugged_in_one_brings_the_robot_back(
    ids: IdService, web: WebServer, device: Device, robot: Program
) -> None:
    robot.wait_for("/Robot0/command")
    device.unplug()
    robot.wait_for("No attached ARDUINO found")
    pings = len(web.pings)
    until(lambda: robot.output.count("No attached ARDUINO found") >= 3)
    assert len(web.pings) <= pings + 1
    with Device(Path(device.path)):
        until(lambda: robot.output.count("/Robot0/command") == 2, 15)
        until(lambda: len(web.pings) > pings + 3)


def test_a_web_server_that_is_away_and_back_changes_nothing_else(
    ids: IdService, web: WebServer, robot: Program
) -> None:
    node = serial_node(robot, 0)
    until(lambda: web.pings)
    web.stop()
    robot.wait_for("Connection to webserver lost")
    web.start()
    robot.wait_for("webserver answers again")
    assert serial_node(robot, 0) == node
    assert len(ids.callers) == 1


@pytest.mark.slow
def test_without_the_service_the_reason_is_said_and_the_robot_tries_again(
    ros_master: RosMaster, tmp_path: Path, robot: Program
) -> None:
    until(lambda: robot.output.count("Service call failed") >= 2, 15)
    service = IdService(ros_master, tmp_path / "next_id")
    robot.wait_for("New robot ID = 0")
    service.kill()


@pytest.mark.slow
def test_without_a_ros_master_the_reason_is_said_and_the_robot_tries_again(device: Device, tmp_path: Path) -> None:
    master = RosMaster(tmp_path)
    env = {**master.env, "LASERBOT_SERIAL": device.path, "LASERBOT_RETRY": "0.2", "LASERBOT_MASTER": "127.0.0.1"}
    robot = Program.python("robot.id_service_client", env={**env, "LASERBOT_WEB_PORT": str(free_port())})
    try:
        robot.wait_for("the ROS master does not answer")
        assert "Traceback" not in robot.output
        master.start()
        service = IdService(master, tmp_path / "next_id")
        robot.wait_for("New robot ID = 0")
        service.kill()
    finally:
        robot.stop()
        master.stop()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_everything_quickly_and_cleanly(
    ids: IdService, web: WebServer, robot: Program, number: signal.Signals
) -> None:
    robot.wait_for("/Robot0/command")
    assert robot.stop(number, seconds=2) == 0
    assert "Traceback" not in robot.output


@pytest.mark.slow
def test_a_signal_ends_it_while_it_asks_the_arduino(device: Device, robot: Program) -> None:
    device.answers = False
    until(lambda: device.topic_requests)
    assert robot.stop(seconds=2) == 0
    assert "Traceback" not in robot.output


def test_the_serial_node_does_not_outlive_a_killed_supervisor(ids: IdService, robot: Program) -> None:
    node = serial_node(robot, 0)
    robot.wait_for("/Robot0/command")
    robot.process.kill()
    robot.process.wait()
    until(lambda: has_ended(node))


def test_a_wrong_setting_ends_it_with_one_line() -> None:
    robot = Program.python("robot.id_service_client", env={"LASERBOT_WEB_PORT": "x", "PYTHONPATH": "build/python"})
    assert robot.exit_code() == 2
    assert robot.output == "robot.id_service_client: LASERBOT_WEB_PORT=x: must be a whole number from 1 to 65535\n"
