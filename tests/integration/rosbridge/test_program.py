"""rosbridge as a program: how it starts, ends, and says what is wrong."""

import re
import signal
import socket
import sys
import time
from xmlrpc.client import ServerProxy

import pytest
import requests
from websockets.exceptions import InvalidStatus

from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import NEUTRAL, Client, RosSide
from tests.support.polling import LATEST, until
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


def test_no_more_clients_of_one_address_are_let_in_than_are_good_for_all(ros_master: RosMaster) -> None:
    rosbridge = Rosbridge(ros_master)
    rosbridge.program.wait_for("listening")
    port = rosbridge.port
    clients = []
    try:
        with pytest.raises(InvalidStatus, match="503"):
            for _ in range(51):
                clients.append(Client(port))
        assert len(clients) == 50
        assert requests.get(f"http://127.0.0.1:{port}", timeout=LATEST).status_code == 426  # it is full, not sick
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
    answer = requests.get(f"http://127.0.0.1:{rosbridge.port}", timeout=LATEST)
    assert answer.status_code == 426
    assert answer.headers["Upgrade"] == "websocket"
    assert answer.headers["Connection"] == "Upgrade, close"
    with Client(rosbridge.port):
        (line,) = rosbridge.program.wait_for(": connected").removeprefix(before).splitlines()
    assert ": connected" in line
    assert rosbridge.program.stop(seconds=2) == 0


def test_calls_of_a_service_that_cannot_be_reached_are_answered_and_none_counts_for_ever(ros_master: RosMaster) -> None:
    rosbridge = Rosbridge(ros_master)
    rosbridge.program.wait_for("listening")
    with ServerProxy(ros_master.uri) as master:  # the master takes any address, even one whose port is no number
        master.registerService("/nobody", "/broken", "rosrpc://127.0.0.1:port", "http://127.0.0.1:1")
    with Client(rosbridge.port).operate() as operator:
        reason = "the ROS master names an impossible address: rosrpc://127.0.0.1:port"
        for number in range(101):  # one more than may be under way at once
            operator.say("call_service", service="/broken", id=number)
            assert operator.hear_error() == f"call_service /broken: {reason}"
            assert operator.hear() == {
                "op": "service_response", "service": "/broken", "values": reason, "result": False, "id": number,
            }  # fmt: skip
    assert rosbridge.program.stop(seconds=2) == 0


def may_call(client: Client) -> bool:
    client.say("call_service", service="/rosapi/get_time")
    while (answer := client.hear())["op"] != "service_response":
        pass
    return bool(answer["result"])


def test_who_guesses_the_operators_token_is_named_and_locks_nobody_out(ros_master: RosMaster) -> None:
    rosbridge = Rosbridge(ros_master)
    rosbridge.program.wait_for("listening")
    with Client(rosbridge.port) as guesser, Client(rosbridge.port) as operator:
        for number in range(9):
            guesser.operate(f"guess {number}")
        operator.operate()
        until(lambda: may_call(operator), 5, "the operator's rights")
        assert not may_call(guesser)
    assert rosbridge.program.stop(seconds=2) == 0
    assert "wrong operator token from 127.0.0.1" in rosbridge.program.output


def test_it_waits_for_the_master_and_can_be_stopped_meanwhile() -> None:
    program = start(ROS_MASTER_URI=f"http://127.0.0.1:{free_port()}", LASERBOT_ROSBRIDGE_PORT=str(free_port()))
    program.wait_for("waiting")
    assert program.stop(seconds=2) == 0
    assert "Traceback" not in program.output


def test_when_the_master_was_restarted_it_begins_anew(own_master: RosMaster) -> None:
    own_master.start()
    rosbridge = Rosbridge(own_master)
    rosbridge.program.wait_for("listening")
    own_master.stop()
    own_master.start()
    until(lambda: rosbridge.program.output.count("listening") == 2, 10, "the second beginning")
    with Client(rosbridge.port).operate() as operator:
        until(lambda: may_call(operator), 5, "rosapi")
    assert rosbridge.program.stop(seconds=2) == 0
    assert "Traceback" not in rosbridge.program.output


def test_a_second_one_on_the_same_master_ends_the_first(own_master: RosMaster) -> None:
    own_master.start()
    first = Rosbridge(own_master)
    first.program.wait_for("listening")
    second = Rosbridge(own_master)
    second.program.wait_for("listening")
    assert first.program.exit_code() == 1
    # the ROS master tells it, unless it has looked itself before
    assert re.search("new node registered with same name|another node has taken the name", first.program.output)
    with Client(second.port).operate() as client:
        client.say("nonsense")
        client.hear_error()
    assert second.program.stop(seconds=2) == 0


@pytest.mark.slow  # the time is real
def test_while_the_master_hangs_a_stream_goes_on_though_its_client_subscribes_and_a_new_one_waits_for_a_second(
    own_master: RosMaster,
) -> None:
    own_master.start()
    rosbridge, robot = Rosbridge(own_master), RosSide(own_master.env)
    rosbridge.program.wait_for("listening")
    try:
        with Client(rosbridge.port).operate() as operator:

            def arrives(topic: str, number: int) -> bool:
                operator.say("publish", topic=topic, msg={"data": number})
                return {"data": number} in robot.heard(topic)

            for topic in ("/stream", "/goal"):
                robot.listen(topic, "std_msgs/Int32")
                operator.say("advertise", topic=topic, type="std_msgs/Int32")
            until(lambda: arrives("/stream", 0))
            other = Client(rosbridge.port).operate()
            other.say("advertise", topic="/goal", type="std_msgs/Int32")

            def other_arrives() -> bool:
                other.say("publish", topic="/goal", msg={"data": 0})
                return bool(robot.heard("/goal"))

            until(other_arrives)
            own_master.pause()
            begin = time.monotonic()
            operator.say("subscribe", topic="/news", type="std_msgs/Int32")
            until(lambda: arrives("/stream", 1))
            assert time.monotonic() - begin < 0.9
            operator.say("publish", topic="/goal", msg={"data": 2})
            until(lambda: {"data": 2} in robot.heard("/goal"))
            assert 0.9 < time.monotonic() - begin < 3
            other.close()
    finally:
        own_master.resume()
        rosbridge.program.stop()
        robot.close()
    assert "Traceback" not in rosbridge.program.output


def test_in_a_simulation_time_is_that_of_its_clock(own_master: RosMaster) -> None:
    own_master.start()
    with ServerProxy(own_master.uri) as master:
        master.setParam("/test", "/use_sim_time", True)
    rosbridge = Rosbridge(own_master)
    rosbridge.program.wait_for("listening")
    with Client(rosbridge.port).operate() as operator:

        def tells(seconds: int, nanoseconds: int) -> bool:
            operator.say("call_service", service="/rosapi/get_time")
            answer = operator.hear()
            if answer["op"] == "status":  # rosapi is not registered yet
                answer = operator.hear()
            return bool(answer["values"] == {"time": {"secs": seconds, "nsecs": nanoseconds}})

        until(lambda: tells(0, 0))
        simulation = Program.python("tests.integration.rosbridge.clock_node", env=own_master.env)
        try:
            simulation.wait_for("ready")
            until(lambda: tells(1000, 250_000_000))
            for topic, kind, message in (
                ("/header", "std_msgs/Header", {"frame_id": "map"}),
                ("/time", "std_msgs/Time", {"data": "now"}),
            ):
                operator.say("advertise", topic=topic, type=kind)
                operator.say("subscribe", topic=topic, type=kind)
                operator.say("publish", topic=topic, msg=message)
                heard = operator.hear()["msg"]
                assert heard.get("stamp", heard.get("data")) == {"secs": 1000, "nsecs": 250_000_000}
            operator.say("subscribe", topic="/time", compression="cbor-raw", id="raw")
            operator.say("publish", topic="/time", msg={"data": "now"})
            raw = operator.hear_cbor()["msg"]
            assert (raw["secs"], raw["nsecs"]) == (1000, 250_000_000)
        finally:
            simulation.stop()
    assert rosbridge.program.stop(seconds=2) == 0
    assert "Traceback" not in rosbridge.program.output


def test_a_port_in_use_is_one_clear_line(ros_master: RosMaster) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        program = start(**ros_master.env, LASERBOT_ROSBRIDGE_PORT=str(port))
        assert program.exit_code() == 1
    (line,) = (said for said in program.output.splitlines() if "laser_bot_battle.priority" not in said)
    assert f"port {port}" in line
    assert "LASERBOT_ROSBRIDGE_PORT" in line


def test_an_impossible_setting_is_one_clear_line() -> None:
    program = start(LASERBOT_ROSBRIDGE_PORT="ninety")
    assert program.exit_code() == 2
    assert (
        program.output
        == "python3 -m server.rosbridge: LASERBOT_ROSBRIDGE_PORT=ninety: must be a whole number from 1 to 65535\n"
    )


def test_help_names_the_settings() -> None:
    program = Program([sys.executable, "-m", "server.rosbridge", "--help"], {"PYTHONPATH": "build/python"})
    assert program.exit_code() == 0
    assert "LASERBOT_OPERATOR_TOKEN" in program.output


def test_ros_arguments_that_are_not_understood_are_named_and_those_of_roslaunch_are_not() -> None:
    strange = ["_port:=29095", "__name:=lab", "chatter:=/chat"]
    usual = ["__name:=rosbridge_websocket", "__log:=/dev/null"]
    program = start(*strange, *usual, ROS_MASTER_URI="http://127.0.0.1:1", LASERBOT_ROSBRIDGE_PORT=str(free_port()))
    program.wait_for("waiting")
    assert program.stop(seconds=2) == 0
    named = [line for line in program.output.splitlines() if ":=" in line]
    assert len(named) == len(strange)
    for argument, line in zip(strange, named, strict=True):
        assert f"{argument} has no effect" in line


def start(*arguments: str, **variables: str) -> Program:
    return Program.python("server.rosbridge", *arguments, env={"PYTHONPATH": "build/python", **variables})
