"""The serial node between a real ROS master and a device on a pseudo-terminal."""

import os
import signal
import socket
import struct
import threading
import time
from pathlib import Path
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from robot.rosserial.frame import encode
from robot.rosserial.topic_info import TopicInfo
from tests.integration.robot.conftest import Start, serve
from tests.integration.robot.device import COMMAND, EMPTY, ROBOT_MSG, STOP_SENDING, TOPIC_REQUEST, Device
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster

FORWARD = bytes.fromhex("ff fe 03 00 fc 64 00 01 00 00 9a")
BACK_LEFT_SHOOT = bytes.fromhex("ff fe 03 00 fc 64 00 ff ff 01 9c")
NEUTRAL = bytes.fromhex("ff fe 03 00 fc 64 00 00 00 00 9b")
HIT = bytes.fromhex("ff fe 00 00 ff 7d 00 82")


def publish(start: Start, topic: str, command: str, period: float = 0.025, count: int = 1) -> Program:
    return start("tests.integration.robot.peers", "publish", topic, str(period), str(count), *command.split())


def send_until_heard(start: Start, device: Device, data: bytes, topic: str, sender: str) -> None:
    """What the device sends again and again is heard on the topic; rospy drops what comes while it still connects."""
    listener = start("tests.integration.robot.peers", "listen", topic)

    def heard() -> bool:
        device.send(data)
        return f"message from {sender}\n" in listener.output

    until(heard, 15)


def test_a_command_reaches_the_device_as_the_bytes_of_the_protocol(start: Start, device: Device) -> None:
    serve(start, device.path, 10)
    publish(start, "/Robot10/command", "1 0 0").wait_for("published")
    until(lambda: FORWARD in device.received)
    publish(start, "/Robot10/command", "-1 -1 1").wait_for("published")
    until(lambda: BACK_LEFT_SHOOT in device.received)


def test_a_hit_of_the_device_is_a_message_of_the_node_that_bears_the_robots_name(start: Start, device: Device) -> None:
    serve(start, device.path, 11)
    send_until_heard(start, device, HIT, "/Robot11/response", "/Robot11")


def test_the_device_gets_neutral_after_the_last_command(start: Start, device: Device) -> None:
    serve(start, device.path, 12)
    publish(start, "/Robot12/command", "1 0 0")
    until(lambda: FORWARD in device.received)
    until(lambda: NEUTRAL in device.received)
    assert device.commands() == [b"\x01\0\0", b"\0\0\0"]


@pytest.mark.slow
def test_neutral_does_not_come_between_the_commands_of_a_stream(start: Start, device: Device) -> None:
    serve(start, device.path, 13)
    publish(start, "/Robot13/command", "1 0 0", period=0.1, count=8).wait_for("published")
    until(lambda: NEUTRAL in device.received)
    assert device.commands() == [b"\x01\0\0"] * 8 + [b"\0\0\0"]


def test_a_flood_of_commands_is_thinned_to_what_the_line_carries(start: Start, device: Device) -> None:
    serve(start, device.path, 14)
    flood = publish(start, "/Robot14/command", "1 0 0", period=0, count=5000)
    until(lambda: FORWARD in device.received)
    begun = time.monotonic()
    flood.wait_for("published", 60)
    line_speed = 57600 / 10 / len(FORWARD)  # commands per s
    assert 2 < len(device.commands()) < 20 + line_speed * (time.monotonic() - begun)


@pytest.mark.slow
def test_of_the_commands_that_come_while_the_line_takes_nothing_the_newest_follows(
    start: Start, device: Device
) -> None:
    serve(start, device.path, 32)
    with device.clogged():
        publish(start, "/Robot32/command", "1 0 0  1 1 0  1 -1 1", count=3).wait_for("published")
    until(lambda: NEUTRAL in device.received)
    written = device.commands()
    assert b"\x01\x01\0" not in written
    # on a busy machine the line is free only when the newest command is too old, and neutral has taken its place
    assert written in ([b"\x01\0\0", b"\x01\xff\x01", b"\0\0\0"], [b"\x01\0\0", b"\0\0\0"])


@pytest.mark.slow
def test_a_device_that_takes_no_command_ends_the_node_with_an_error(start: Start, device: Device) -> None:
    node = serve(start, device.path, 33)
    with device.clogged():
        publish(start, "/Robot33/command", "1 0 0", count=1000)
        assert node.exit_code() == 1
    assert "Connection to Arduino lost: cannot write to" in node.output
    assert "Traceback" not in node.output


def test_the_device_gets_the_time_that_it_asks_for(start: Start, device: Device) -> None:
    serve(start, device.path, 15)
    times = until(lambda: [frame.payload for frame in device.frames if frame.topic_id == 10])
    secs, nsecs = struct.unpack("<II", times[0])
    assert abs(secs + nsecs / 1e9 - time.time()) < 10


def test_garbage_and_half_frames_do_not_stop_the_hits(start: Start, device: Device) -> None:
    serve(start, device.path, 16)
    noisy = os.urandom(50).replace(b"\xff", b"") + HIT[:5] + HIT + b"\xff\xfe\x01"
    send_until_heard(start, device, noisy, "/Robot16/response", "/Robot16")


def test_an_unplugged_device_ends_the_node_with_an_error(start: Start, device: Device) -> None:
    node = serve(start, device.path, 17)
    device.unplug()
    assert node.exit_code() == 1
    assert "Connection to Arduino lost" in node.output
    assert "Traceback" not in node.output


@pytest.mark.slow
def test_a_device_that_never_answers_ends_the_node_with_an_error(start: Start, device: Device) -> None:
    device.answers = False
    node = start("robot.serial_node", device.path, "__name:=Robot18")
    until(lambda: device.topic_requests >= 3, 10, "topics asked for again and again")
    device.send(b"not rosserial at all\xff\xfe" * 5)
    assert node.exit_code(30) == 1
    assert "no answer to the topic request" in node.output
    assert "stray bytes" in node.output


def test_a_missing_device_is_an_error_of_one_line(start: Start, tmp_path: Path) -> None:
    node = start("robot.serial_node", str(tmp_path / "nothing"), "__name:=Robot19")
    assert node.exit_code() == 1
    assert "cannot open" in node.output
    assert "Traceback" not in node.output


def test_a_port_that_is_in_use_is_refused(start: Start, device: Device) -> None:
    serve(start, device.path, 20)
    second = start("robot.serial_node", device.path, "__name:=Robot21")
    assert second.exit_code() == 1
    assert "cannot open" in second.output


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_node_cleanly_and_leaves_the_robot_neutral(
    start: Start, device: Device, number: signal.Signals
) -> None:
    node = serve(start, device.path, 22)
    publish(start, "/Robot22/command", "1 0 0")
    until(lambda: FORWARD in device.received)
    assert node.stop(number, seconds=2) == 0
    until(lambda: NEUTRAL + STOP_SENDING in device.received)
    assert "Traceback" not in node.output


def test_no_command_follows_what_stops_the_device(start: Start, device: Device) -> None:
    node = serve(start, device.path, 34)
    publish(start, "/Robot34/command", "1 0 0", period=0, count=100_000_000)
    until(lambda: len(device.commands()) > 100)
    assert node.stop(signal.SIGINT, seconds=2) == 0
    until(lambda: device.received.endswith(NEUTRAL + STOP_SENDING))
    assert "Traceback" not in node.output


def test_an_absent_ros_master_is_an_error_of_one_line(device: Device, ros_master: RosMaster) -> None:
    env = {**ros_master.env, "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}"}
    node = Program.python("robot.serial_node", device.path, "__name:=Robot23", env=env)
    assert node.exit_code() == 1
    assert "does not answer" in node.output
    assert "Traceback" not in node.output


@pytest.mark.slow
def test_so_is_one_that_falls_silent_meanwhile(device: Device) -> None:
    silent = threading.Event()
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as master:
        master.register_function(lambda *_: (1, "", 0), "setParam")
        master.register_function(lambda *_: (1, "", silent.wait(20)), "getParam")
        thread = threading.Thread(target=master.serve_forever)
        thread.start()
        env = {"ROS_MASTER_URI": f"http://127.0.0.1:{master.server_address[1]}"}
        node = Program.python("robot.serial_node", device.path, "__name:=Robot34", env=env)
        try:
            assert node.exit_code() == 1
        finally:
            node.kill()
            silent.set()
            master.shutdown()
            thread.join()
    assert "does not answer" in node.output
    assert "Traceback" not in node.output


@pytest.mark.slow
def test_a_ros_master_that_hangs_stops_neither_the_node_nor_its_commands(device: Device, tmp_path: Path) -> None:
    master = RosMaster(tmp_path)
    master.start()
    node = Program.python("robot.serial_node", device.path, "__name:=Robot31", env=master.env)
    arguments = ("publish", "/command", "0.1", "100000", "1", "0", "0")
    driver = Program.python("tests.integration.robot.peers", *arguments, env=master.env)
    try:
        until(device.commands, 15)
        master.pause()
        before = len(device.commands())
        until(lambda: len(device.commands()) > before + 100, 20, "commands of 10 s")
        node.wait_for("does not answer")
        master.resume()
        node.wait_for("the ROS master answers again")
        assert node.running
    finally:
        master.resume()
        driver.kill()
        node.kill()
        master.stop()


@pytest.mark.slow
def test_it_ends_also_while_the_ros_master_hangs(device: Device, tmp_path: Path) -> None:
    master = RosMaster(tmp_path)
    master.start()
    node = Program.python("robot.serial_node", device.path, "__name:=Robot32", env=master.env)
    try:
        node.wait_for("/command")
        master.pause()
        assert node.stop(signal.SIGTERM, seconds=5) == 0
    finally:
        master.resume()
        node.kill()
        master.stop()


def test_a_restarted_ros_master_ends_the_node(device: Device, tmp_path: Path) -> None:
    master = RosMaster(tmp_path)
    master.start()
    node = Program.python("robot.serial_node", device.path, "__name:=Robot24", env=master.env)
    try:
        node.wait_for("/command")
        master.stop()
        master.start()
        assert node.exit_code() == 1
        assert "ROS master was restarted" in node.output
    finally:
        node.kill()
        master.stop()


@pytest.mark.slow
def test_a_node_whose_name_is_taken_ends(start: Start, device: Device, tmp_path: Path) -> None:
    node = serve(start, device.path, 25)
    with Device(tmp_path / "ttyACM1") as other:
        serve(start, other.path, 25)
        assert node.exit_code() == 1
        assert "another node has taken" in node.output


def test_topics_that_cannot_be_joined_are_refused_and_the_others_work(start: Start, tmp_path: Path) -> None:
    other_version = TopicInfo(101, "old", ROBOT_MSG[0], "0" * 32, 280)
    unknown_type = TopicInfo(102, "strange", "no_such_msgs/Thing", "1" * 32, 280)
    bad_name = TopicInfo(103, "not a name!", *EMPTY, 280)
    with Device(tmp_path / "ttyACM0", subscribers=(other_version, unknown_type, bad_name, COMMAND)) as device:
        node = serve(start, device.path, 26)
        publish(start, "/Robot26/command", "1 0 0").wait_for("published")
        until(lambda: FORWARD in device.received)
        assert "'not a name!' is not a legal name" in node.output
        assert "'old' of the device has another version" in node.output
        assert "no_such_msgs/Thing', which is not installed" in node.output


def test_other_topics_and_ids_of_any_sketch_work_and_have_no_dead_man(start: Start, tmp_path: Path) -> None:
    button = TopicInfo(130, "button", *EMPTY, 280)
    buzzer = TopicInfo(107, "buzzer", *ROBOT_MSG, 280)
    too_small = TopicInfo(108, "small", *ROBOT_MSG, 2)
    with Device(tmp_path / "tty", subscribers=(buzzer, too_small), publishers=(button,)) as device:
        node = start("robot.serial_node", device.path, "__name:=sketch27")
        node.wait_for("/small")
        send_until_heard(start, device, encode(130), "/button", "/sketch27")
        publish(start, "/buzzer", "1 1 1").wait_for("published")
        until(lambda: encode(107, b"\1\1\1") in device.received)
        publish(start, "/small", "1 1 1").wait_for("published")
        node.wait_for("longer than the device's buffer of 2")


def test_a_log_line_of_the_sketch_and_a_broken_message_are_logged(start: Start, tmp_path: Path) -> None:
    string = TopicInfo(126, "name", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", 280)
    with Device(tmp_path / "tty", publishers=(string,)) as device:
        node = serve(start, device.path, 28)
        device.send(encode(7, b"\x02" + struct.pack("<I", 7) + b"low bat"))
        node.wait_for(" INFO robot.serial_node: /Robot28 serves ")
        node.wait_for(" WARNING robot.arduino: low bat\n")
        device.send(encode(126, b"\xff\xff\xff"))
        node.wait_for("message of 3 bytes on /name dropped")


def test_the_uart_may_be_on_tcp(start: Start) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        node = start("robot.serial_node", f"socket://127.0.0.1:{server.getsockname()[1]}", "command:=/Robot29/command")
        server.settimeout(10)
        uart, _ = server.accept()
    with uart:
        uart.settimeout(10)
        assert uart.recv(8) == TOPIC_REQUEST
        uart.sendall(encode(1, COMMAND.encode()))
        publish(start, "/Robot29/command", "1 0 0")
        assert uart.recv(11) == FORWARD
    assert node.exit_code() == 1
    assert "Connection to Arduino lost" in node.output


def test_a_killed_supervisor_ends_the_node(device: Device, ros_master: RosMaster) -> None:
    # Program gives it an empty stdin, as a pipe is whose writer was killed
    node = Program.python("robot.serial_node", device.path, "--end-with-stdin", "__name:=Robot30", env=ros_master.env)
    assert node.exit_code() == 1
    assert "the program that started this node is gone" in node.output


@pytest.mark.parametrize("device_url", ["socket://127.0.0.1", "nonsense://x", "socket://127.0.0.1:notaport"])
def test_a_bad_url_is_an_error_of_one_line(start: Start, device_url: str) -> None:
    node = start("robot.serial_node", device_url)
    assert node.exit_code() == 1
    assert "cannot open" in node.output
    assert "Traceback" not in node.output
