"""What the serial node is for other sketches: services, parameters, logs, health; and what it refuses."""

import signal
import struct
import threading
import time
from pathlib import Path
from typing import Any
from xmlrpc.server import SimpleXMLRPCServer

import pytest
from sensor_msgs.msg import LaserScan

from laser_bot_battle.master import Master
from laser_bot_battle.msg import BoardHealth, Setup
from robot.rosserial.announcements import MAX_TOPICS
from robot.rosserial.frame import encode
from robot.rosserial.topic_info import TopicInfo
from robot.serial.device_topics import serialised
from tests.integration.robot.conftest import Start, serve
from tests.integration.robot.device import COMMAND, EMPTY, RESPONSE, ROBOT_MSG, Device
from tests.support.polling import until
from tests.support.programs import Program
from tests.support.ros import RosMaster

TRIGGER = ("std_srvs/Trigger", "d41d8cd98f00b204e9800998ecf8427e", "937c9679a518e3a18d831e57125ea522")
BOARD = TopicInfo(127, "board", BoardHealth._type, BoardHealth._md5sum, 280)
FORWARD = encode(100, b"\1\0\0")


def string(text: str) -> bytes:
    return struct.pack("<I", len(text)) + text.encode()


def peer(start: Start, *words: str) -> Program:
    return start("tests.integration.robot.peers", *words)


def show(start: Start, topic: str, kind: str) -> Program:
    """Once it has subscribed: rospy misses a publisher that appears in the moment of subscribing."""
    shown = peer(start, "show", topic, kind)
    shown.wait_for("subscribed")
    return shown


def test_port_and_baud_are_private_parameters_as_of_rosserial_python(start: Start, device: Device) -> None:
    node = start("robot.serial_node", f"_port:={device.path}", "_baud:=115200", "__name:=Robot40")
    node.wait_for(f"/Robot40 serves {device.path}")
    node.wait_for("/command")


def test_roslaunch_may_have_set_the_port_and_a_bad_speed_is_told(
    start: Start, device: Device, ros_master: RosMaster
) -> None:
    master = Master(ros_master.uri, "test")
    master.call("setParam", "/Robot41/port", device.path)
    master.call("setParam", "/Robot41/baud", "fast")
    node = start("robot.serial_node", "__name:=Robot41")
    assert node.exit_code() == 1
    assert "~baud is 'fast': it must be a positive whole number" in node.output
    master.call("setParam", "/Robot41/baud", 57600)
    start("robot.serial_node", "__name:=Robot41").wait_for(f"/Robot41 serves {device.path}")


def test_without_a_port_the_arduino_is_looked_for(device: Device, ros_master: RosMaster) -> None:
    env = {**ros_master.env, "LASERBOT_SERIAL": f"/nowhere {device.path}"}
    node = Program.python("robot.serial_node", "__name:=Robot42", env=env)
    try:
        node.wait_for(f"/Robot42 serves {device.path}")
    finally:
        node.kill()


def test_ros_calls_a_service_of_the_device(start: Start, tmp_path: Path) -> None:
    kind, request, answer = TRIGGER
    halves = ((2, TopicInfo(126, "fire", kind, answer, 280)), (3, TopicInfo(101, "fire", kind, request, 280)))
    with Device(tmp_path / "tty", halves=halves) as device:
        serve(start, device.path, 43).wait_for("/fire (std_srvs/Trigger) joined")
        caller = peer(start, "call", "/fire")
        until(lambda: device.payloads(101) == [b""], 20)
        device.send(encode(126, b"\1" + string("bang")))
        until(lambda: 'success: True message: "bang"' in caller.output)


def test_the_device_calls_a_service_of_ros(start: Start, tmp_path: Path) -> None:
    kind, request, answer = TRIGGER
    halves = ((4, TopicInfo(127, "ask", kind, request, 280)), (5, TopicInfo(102, "ask", kind, answer, 280)))
    with Device(tmp_path / "tty", halves=halves) as device:
        node = serve(start, device.path, 44)
        node.wait_for("/ask (std_srvs/Trigger) joined")
        device.send(encode(127))
        node.wait_for("call of /ask by the device failed")
        peer(start, "serve", "/ask").wait_for("ready")
        device.send(encode(127))
        until(lambda: device.payloads(102) == [b"\1" + string("from ROS")], 20)


def test_the_device_gets_the_parameters_of_the_ros_master(start: Start, device: Device, ros_master: RosMaster) -> None:
    master = Master(ros_master.uri, "test")
    for name, value in {"gain": [1, -2], "scale": 0.5, "title": ["a", "bc"], "on": True}.items():
        master.call("setParam", f"/{name}", value)
    node = serve(start, device.path, 45)

    def ask(name: str) -> bytes:
        known = len(device.payloads(6))
        device.send(encode(6, string(name)))
        return until(lambda: device.payloads(6)[known:], what=name)[0]

    assert ask("gain") == struct.pack("<IiiII", 2, 1, -2, 0, 0)
    assert ask("scale") == struct.pack("<IIfI", 0, 1, 0.5, 0)
    assert ask("title") == struct.pack("<III", 0, 0, 2) + string("a") + string("bc")
    assert ask("on") == struct.pack("<IiII", 1, 1, 0, 0)
    assert ask("nothing") == bytes(12)
    node.wait_for("the device asks for parameter 'nothing' and gets none")


def test_log_lines_of_the_device_are_in_rosout_and_the_line_is_in_diagnostics(start: Start, device: Device) -> None:
    rosout = show(start, "/rosout", "rosgraph_msgs/Log")
    diagnostics = show(start, "/diagnostics", "diagnostic_msgs/DiagnosticArray")
    serve(start, device.path, 46)

    def told() -> bool:
        device.send(encode(7, b"\x02" + string("low bat")))
        return 'level: 4 name: "/Robot46" msg: "low bat"' in rosout.output

    until(told)
    until(lambda: 'name: "Robot46: serial line" message: "the device answers"' in diagnostics.output)


def test_a_flood_of_log_lines_is_some_lines_and_one_about_the_others(start: Start, device: Device) -> None:
    rosout = show(start, "/rosout", "rosgraph_msgs/Log")
    node = serve(start, device.path, 57)

    def is_heard() -> bool:
        device.send(encode(7, b"\x01" + string("here")))
        return 'msg: "here"' in rosout.output

    until(is_heard)
    device.send(encode(7, b"\x01" + string("flood")) * 2000 + encode(7, b"broken") * 2000)
    rosout.wait_for("further log lines of the sketch were left out")
    node.wait_for("further log lines of the sketch were left out")
    node.wait_for("broken log message")
    assert rosout.output.count("flood") < 200  # none, perhaps, if it took many words to be heard
    assert node.output.count("flood") < 200
    assert node.output.count("broken log message") < 200


@pytest.mark.slow  # 20 s of real time
def test_parameter_requests_do_not_starve_commands(start: Start, device: Device, ros_master: RosMaster) -> None:
    """The requests fill the line to 45 %; the driver sends 800 commands in 20 s."""
    Master(ros_master.uri, "test").call("setParam", "/gain", list(range(10)))
    serve(start, device.path, 47)
    request = encode(6, string("gain"))
    driver = peer(start, "publish", "/Robot47/command", "0.025", "800", "1", "0", "0")
    until(device.commands, 20)
    begun = sent = 0.0
    begun = time.monotonic()
    while "published" not in driver.output:
        while sent < 0.45 * 5760 * (time.monotonic() - begun):
            device.send(request)
            sent += len(request)
        assert time.monotonic() < begun + 120
        time.sleep(0.01)
    assert len(device.payloads(6)) > 100
    assert len(device.commands()) > 600


def test_a_device_with_10000_topics_is_refused_at_once(start: Start, tmp_path: Path) -> None:
    many = tuple(TopicInfo(200 + number, f"t{number}", *EMPTY, 280) for number in range(10_000))
    with Device(tmp_path / "tty", publishers=many) as device:
        node = start("robot.serial_node", device.path, "__name:=Robot48")
        assert node.exit_code() == 1
        assert f"the device tells more than {MAX_TOPICS} topics" in node.output


def test_it_ends_while_many_topics_are_being_joined(tmp_path: Path) -> None:
    master = RosMaster(tmp_path)
    master.start()
    many = tuple(TopicInfo(200 + number, f"t{number}", *EMPTY, 280) for number in range(MAX_TOPICS - 1))
    try:
        with Device(tmp_path / "tty", publishers=many) as device:
            node = Program.python("robot.serial_node", device.path, "__name:=Robot49", env=master.env)
            node.wait_for("/t3 (")
            master.pause()
            assert node.stop(signal.SIGTERM, seconds=3) == 0
    finally:
        master.resume()
        node.kill()
        master.stop()


def test_names_of_other_robots_and_of_the_master_are_refused(start: Start, tmp_path: Path) -> None:
    subscribers = (
        TopicInfo(101, "/Robot1/command", *ROBOT_MSG, 280),
        TopicInfo(102, "Robot2/command", *ROBOT_MSG, 280),
        TopicInfo(103, "/Robot50/extra", *ROBOT_MSG, 280),
        TopicInfo(104, "none", *ROBOT_MSG, 0),
        COMMAND,
    )
    publishers = (TopicInfo(125, "/shots", *EMPTY, 280),)
    with Device(tmp_path / "tty", subscribers, publishers) as device:
        node = serve(start, device.path, 50)
        node.wait_for("/Robot50/extra (laser_bot_battle/Robot_msg) joined")
        assert "topic '/Robot1/command' is another robot's: this one is /Robot50" in node.output
        assert "topic 'Robot2/command' is another robot's" in node.output
        assert "topic '/shots' is the master's" in node.output
        assert "topic 'none' with a buffer of 0 bytes refused" in node.output
        assert "joined, id 101" not in node.output


@pytest.mark.slow
def test_our_firmware_that_is_mute_is_noticed_within_5_s(start: Start, tmp_path: Path) -> None:
    with Device(tmp_path / "tty", publishers=(RESPONSE, BOARD)) as device:
        node = serve(start, device.path, 51)
        node.wait_for("board (laser_bot_battle/BoardHealth) joined")
        device.answers = False
        assert node.exit_code() == 1
        assert "no time request for 5 s and no answer to the topic request" in node.output


@pytest.mark.slow  # 12 s of real time
def test_any_other_sketch_may_be_silent_while_it_waits(start: Start, device: Device) -> None:
    node = serve(start, device.path, 60)
    device.answers = False
    asked = device.topic_requests
    until(lambda: device.topic_requests == asked + 5, 20, "questions of 11 s")
    device.answers = True
    until(lambda: device.topic_requests == asked + 6, 20, "that it has answered")
    driver = peer(start, "publish", "/Robot60/command", "0.1", "1", "1", "0", "0")
    until(device.commands)
    driver.kill()
    assert node.running


def test_the_last_setup_is_sent_again_to_a_device_that_tells_its_topics_again(start: Start, tmp_path: Path) -> None:
    setup = TopicInfo(101, "setup", Setup._type, Setup._md5sum, 280)
    with Device(tmp_path / "tty", subscribers=(COMMAND, setup)) as device:
        node = start("robot.serial_node", device.path, "__name:=Robot52", "setup:=/Robot52/setup")
        node.wait_for("/Robot52/setup")
        peer(start, "setup", "/Robot52/setup", "52", "1", "1")
        wanted = serialised(Setup(52, 1, Setup.CODED, 500, 0))
        until(lambda: device.payloads(101) == [wanted], 20)
        # it is silent, so it is asked for its topics, and tells them
        until(lambda: device.payloads(101)[1:] == [wanted], 20)


def test_a_setup_that_was_lost_on_the_line_is_sent_again_until_the_board_is_in_its_mode(
    start: Start, tmp_path: Path
) -> None:
    setup = TopicInfo(101, "setup", Setup._type, Setup._md5sum, 280)
    with Device(tmp_path / "tty", subscribers=(COMMAND, setup), publishers=(BOARD,)) as device:
        node = start("robot.serial_node", device.path, "__name:=Robot54", "setup:=/Robot54/setup")
        node.wait_for("/Robot54/setup")
        peer(start, "setup", "/Robot54/setup", "54", "1", "1")
        until(lambda: device.payloads(101), 20)

        def told(mode: int) -> int:
            """How many setups have come when the board has said its mode, and that was heard, but for those that
            follow when the topics are told: a busy machine is silent for so long that they are asked for."""
            device.send(encode(127, serialised(BoardHealth(mode=mode))) + encode(10, bytes(8)))
            answers = len(device.payloads(10))
            until(lambda: len(device.payloads(10)) > answers)
            return len(device.payloads(101)) - device.topic_requests

        before = told(Setup.CODED)
        assert told(Setup.CODED) == before
        assert told(Setup.PLAIN) == before + 1
        assert told(Setup.CODED) == before + 1
        assert set(device.payloads(101)) == {serialised(Setup(54, 1, Setup.CODED, 500, 0))}


@pytest.mark.slow
def test_a_publisher_of_the_setup_that_did_not_answer_is_asked_again(
    start: Start, ros_master: RosMaster, tmp_path: Path
) -> None:
    setup = TopicInfo(101, "setup", Setup._type, Setup._md5sum, 280)
    asked: list[str] = []

    def request_topic(caller: Any, topic: Any, _: Any) -> Any:
        asked.append(f"{caller} {topic}")
        return 0, "busy", []

    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as publisher:
        publisher.register_function(request_topic, "requestTopic")
        thread = threading.Thread(target=publisher.serve_forever)
        thread.start()
        try:
            uri = f"http://127.0.0.1:{publisher.server_address[1]}"
            Master(ros_master.uri, "busy").call("registerPublisher", "/Robot55/setup", Setup._type, uri)
            with Device(tmp_path / "tty", subscribers=(COMMAND, setup)) as device:
                start("robot.serial_node", device.path, "__name:=Robot55", "setup:=/Robot55/setup")
                until(lambda: len(asked) >= 3, 20, "asked again")
        finally:
            publisher.shutdown()
            thread.join()
    assert set(asked) == {"/Robot55 /Robot55/setup"}


def test_a_board_with_large_buffers_sends_and_gets_messages_up_to_them_and_is_told_of_longer_ones(
    start: Start, ros_master: RosMaster, tmp_path: Path
) -> None:
    kind = ("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1")
    scan, text, neighbour = (
        TopicInfo(126, "scan", "sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369", 16_384),
        TopicInfo(101, "text", *kind, 16_384),
        TopicInfo(102, "short", *kind, 280),
    )
    laser = serialised(LaserScan(ranges=[1.5] * 720, intensities=[0.25] * 720))
    assert len(laser) > 5800
    with Device(tmp_path / "tty", subscribers=(COMMAND, text, neighbour), publishers=(scan,)) as device:
        shown = show(start, "/scan", "sensor_msgs/LaserScan")
        node = serve(start, device.path, 58)
        node.wait_for("/scan (sensor_msgs/LaserScan) joined")

        def is_heard() -> bool:
            device.send(encode(126, laser))
            return "ranges: [1.5, 1.5, " in shown.output

        until(is_heard)
        for topic in "text", "short":
            peer(start, "text", f"/{topic}", "16000")
        until(lambda: device.payloads(101) == [string("x" * 16_000)], 20)
        node.wait_for("message of 16004 bytes for short dropped: longer than the device's buffer of 280")
        assert "noise" not in node.output
        device.send(encode(126, bytes(20_000)))
        node.wait_for("dropped a frame of 20000 bytes from the device")
        assert "noise" not in node.output


def test_the_neutral_of_a_robot_does_not_wait_for_a_long_message(start: Start, tmp_path: Path) -> None:
    text = TopicInfo(101, "text", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", 65_535)
    with Device(tmp_path / "tty", subscribers=(COMMAND, text)) as device:
        serve(start, device.path, 59).wait_for("/text (std_msgs/String) joined")
        driver = peer(start, "publish", "/Robot59/command", "0.05", "100000", "1", "0", "0")
        until(device.commands)
        peer(start, "text", "/text", "60000")
        until(lambda: b"xxx" in device.received)
        driver.kill()
        until(lambda: encode(100, bytes(3)) in device.received, 5, "neutral")
        assert device.received.count(b"x") < 60_000, "all of it takes the line for 10 s"


def test_health_is_the_boards_and_the_raspberry_pis(start: Start, tmp_path: Path) -> None:
    with Device(tmp_path / "tty", publishers=(BOARD,)) as device:
        shown = show(start, "/Robot53/health", "laser_bot_battle/Health")
        node = serve(start, device.path, 53)
        until(lambda: "has_board: False" in shown.output)
        node.wait_for("board (laser_bot_battle/BoardHealth) joined")
        device.send(encode(127, serialised(BoardHealth(major=1, supply=4987))))
        until(lambda: "has_board: True" in shown.output and "supply: 4987" in shown.output)
        until(lambda: "has_board: False" in shown.output.rpartition("has_board: True")[2], 20, "old news is none")
