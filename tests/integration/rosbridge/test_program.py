"""rosbridge as a program: how it starts, ends, and says what is wrong."""

import signal
import socket
import sys
from xmlrpc.client import ServerProxy

import pytest
import requests
from websockets.exceptions import InvalidStatus

from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import NEUTRAL, Client, RosSide
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster


@pytest.mark.parametrize("sig", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(ros_master: RosMaster, sig: signal.Signals) -> None:
    rosbridge = Rosbridge(ros_master)
    rosbridge.program.wait_for("listening")
    with Client(rosbridge.port) as client:
        assert rosbridge.program.stop(sig, seconds=2) == 0
        with pytest.raises(Exception, match="1001"):
            client.hear()
    assert "Traceback" not in rosbridge.program.output


def test_the_robot_stops_when_rosbridge_ends(ros_master: RosMaster, ros: RosSide) -> None:
    ros.listen("/Robot9/command")
    rosbridge = Rosbridge(ros_master)
    rosbridge.program.wait_for("listening")
    with Client(rosbridge.port).operate() as operator:

        def arrives() -> bool:
            operator.drive(9)
            return bool(ros.heard("/Robot9/command"))

        until(arrives)
        assert rosbridge.program.stop(seconds=2) == 0
        until(lambda: ros.heard("/Robot9/command")[-1] == NEUTRAL)
        with pytest.raises(Exception, match="1001"):
            operator.hear()


def test_no_more_clients_than_it_can_serve_are_let_in(ros_master: RosMaster) -> None:
    rosbridge = Rosbridge(ros_master)
    rosbridge.program.wait_for("listening")
    port = rosbridge.port
    clients = []
    try:
        with pytest.raises(InvalidStatus, match="503"):
            for _ in range(101):
                clients.append(Client(port))
        assert len(clients) == 100
        assert requests.get(f"http://127.0.0.1:{port}", timeout=5).status_code == 426  # it is full, not sick
    finally:
        for connected in clients:
            connected.close()
    until(lambda: may_connect(port), what="a place after others have left")
    assert rosbridge.program.stop(seconds=2) == 0


def may_connect(port: int) -> bool:
    try:
        Client(port).close()
    except InvalidStatus:
        return False
    return True


def test_a_plain_request_is_told_to_upgrade_and_leaves_no_line_in_the_log(ros_master: RosMaster) -> None:
    rosbridge = Rosbridge(ros_master)
    before = rosbridge.program.wait_for("listening")
    answer = requests.get(f"http://127.0.0.1:{rosbridge.port}", timeout=5)
    assert answer.status_code == 426
    assert answer.headers["Upgrade"] == "websocket"
    assert answer.headers["Connection"] == "close, Upgrade"
    with Client(rosbridge.port):
        (line,) = rosbridge.program.wait_for(": connected").removeprefix(before).splitlines()
    assert ": connected" in line
    assert rosbridge.program.stop(seconds=2) == 0


def test_a_service_call_that_fails_in_an_unforeseen_way_is_answered_and_logged(ros_master: RosMaster) -> None:
    rosbridge = Rosbridge(ros_master)
    rosbridge.program.wait_for("listening")
    with ServerProxy(ros_master.uri) as master:  # the master takes any address, even one whose port is no number
        master.registerService("/nobody", "/broken", "rosrpc://127.0.0.1:port", "http://127.0.0.1:1")
    with Client(rosbridge.port).operate() as operator:
        for number in range(17):  # one more than may be under way at once
            operator.say("call_service", service="/broken", id=number)
            assert operator.hear_error() == "call_service /broken: the call failed"
            assert operator.hear() == {
                "op": "service_response", "service": "/broken", "values": "the call failed", "result": False,
                "id": number,
            }  # fmt: skip
    assert "the call of /broken failed\nTraceback" in rosbridge.program.output
    assert rosbridge.program.stop(seconds=2) == 0


def test_it_waits_for_the_master_and_can_be_stopped_meanwhile() -> None:
    program = start(ROS_MASTER_URI=f"http://127.0.0.1:{free_port()}", LASERBOT_ROSBRIDGE_PORT=str(free_port()))
    program.wait_for("waiting")
    assert program.stop(seconds=2) == 0
    assert "Traceback" not in program.output


def test_it_fails_when_the_master_was_restarted_so_that_it_is_started_again(own_master: RosMaster) -> None:
    own_master.start()
    rosbridge = Rosbridge(own_master)
    rosbridge.program.wait_for("listening")
    own_master.stop()
    own_master.start()
    assert rosbridge.program.process.wait(10) == 1
    assert "is started again" in rosbridge.program.output
    assert "Traceback" not in rosbridge.program.output


def test_a_master_that_hangs_does_not_end_it_nor_hold_it(own_master: RosMaster) -> None:
    own_master.start()
    rosbridge = Rosbridge(own_master)
    rosbridge.program.wait_for("listening")
    own_master.pause()
    try:
        rosbridge.program.wait_for("does not answer")
        assert rosbridge.program.stop(signal.SIGTERM, seconds=3) == 0
    finally:
        own_master.resume()
        rosbridge.program.kill()


def test_a_port_in_use_is_one_clear_line(ros_master: RosMaster) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        program = start(**ros_master.env, LASERBOT_ROSBRIDGE_PORT=str(port))
        assert program.process.wait(10) == 1
    (line,) = program.output.splitlines()
    assert f"port {port}" in line
    assert "LASERBOT_ROSBRIDGE_PORT" in line


def test_an_impossible_setting_is_one_clear_line() -> None:
    program = start(LASERBOT_ROSBRIDGE_PORT="ninety")
    assert program.process.wait(10) == 2
    assert (
        program.output
        == "python3 -m server.rosbridge: LASERBOT_ROSBRIDGE_PORT=ninety: must be a whole number from 1 to 65535\n"
    )


def test_help_names_the_settings() -> None:
    program = Program([sys.executable, "-m", "server.rosbridge", "--help"], {"PYTHONPATH": "build/python"})
    assert program.process.wait(10) == 0
    assert "LASERBOT_OPERATOR_TOKEN" in program.output


def start(**variables: str) -> Program:
    return Program.python("server.rosbridge", env={"PYTHONPATH": "build/python", **variables})
