"""Boards that connect by TCP, as to upstream's rosserial_server: each becomes a robot."""

import contextlib
import signal
import socket
import struct
from collections.abc import Iterator

import psutil
import pytest

from robot.board_server import MAX_OF_ONE_MACHINE
from robot.rosserial.frame import encode
from robot.rosserial.host import ANSWER_TIMEOUT
from robot.rosserial.topic_info import TopicInfo
from tests.integration.robot.conftest import Start
from tests.integration.robot.id_service import IdService
from tests.integration.robot.tcp_board import TcpBoard
from tests.integration.robot.web_server import WebServer
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.processes import command_line, descendants
from tests.support.programs import Program
from tests.support.ros import RosMaster

HIT = encode(125)


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.fixture
def server(settings: dict[str, str], port: int) -> Iterator[Program]:
    """The program under test."""
    env = {**settings, "LASERBOT_SERIAL": f"tcp-listen://127.0.0.1:{port}"}
    program = Program.python("robot.id_service_client", env=env)
    try:
        program.wait_for(f"boards may connect to port {port}")
        yield program
    finally:
        program.stop()


def robots(server: Program) -> list[str]:
    """The command lines of the serial nodes that it has started."""
    return [line for one in descendants(server.process.pid) if "__name:=Robot" in (line := command_line(one))]


def pinged(web: WebServer) -> set[str]:
    """The IDs that have pinged since they were last forgotten."""
    return {body.partition("&")[0] for _, _, body in web.pings}


def test_a_board_that_connects_is_a_robot_until_it_leaves(
    ids: IdService, web: WebServer, server: Program, port: int, start: Start
) -> None:
    assert robots(server) == []
    listener = start("tests.integration.robot.peers", "listen", "/Robot0/response")
    listener.wait_for("subscribed")  # rospy misses a publisher that appears in the moment of subscribing
    with TcpBoard(port) as board:
        server.wait_for("/Robot0/command")
        assert ids.callers == ["/id_service_client_board_127_0_0_1"]
        until(lambda: pinged(web) == {"ID=0"})
        driver = start("tests.integration.robot.peers", "publish", "/Robot0/command", "0.1", "1", "1", "0", "0")
        until(lambda: board.commands() == [b"\1\0\0", bytes(3)], what="the command, and neutral 300 ms later")
        driver.kill()

        def is_hit() -> bool:
            board.send(HIT)
            return "message from /Robot0\n" in listener.output

        until(is_hit)
        board.send(encode(10, bytes(8)))
        until(lambda: any(frame.topic_id == 10 and any(frame.payload) for frame in board.frames), what="the time")
    server.wait_for("board-127.0.0.1 has gone")
    pings = len(web.pings)
    assert robots(server) == []
    ids.give("1")
    with TcpBoard(port):
        until(lambda: "ID=1" in pinged(web))
        assert ids.callers == ["/id_service_client_board_127_0_0_1"] * 2
        assert {body.partition("&")[0] for _, _, body in web.pings[pings:]} == {"ID=1"}


def test_each_board_is_a_robot_of_its_own_and_the_end_of_the_program_ends_all(
    ids: IdService, web: WebServer, server: Program, port: int, start: Start
) -> None:
    with TcpBoard(port) as first:
        until(lambda: "ID=0" in pinged(web))
        ids.give("1")
        with TcpBoard(port, address="::1") as second:
            server.wait_for("/Robot1/command")
            assert ids.callers == [f"/id_service_client_board_{address}" for address in ("127_0_0_1", "__1")]
            start("tests.integration.robot.peers", "publish", "/Robot1/command", "0.1", "1", "1", "1", "0")
            until(lambda: b"\1\1\0" in second.commands())
            assert first.commands() == []
            assert len(robots(server)) == 2
            children = descendants(server.process.pid)
            assert server.stop(signal.SIGTERM) == 0
            psutil.wait_procs(children, 5)
            assert not [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
            until(lambda: first.closed and second.closed)
    assert "Traceback" not in server.output


@pytest.mark.slow
def test_a_board_with_large_buffers_sends_large_messages(
    ids: IdService, server: Program, port: int, start: Start
) -> None:
    text = TopicInfo(126, "text", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", 65_535)
    shown = start("tests.integration.robot.peers", "show", "/text", "std_msgs/String")
    shown.wait_for("subscribed")  # rospy misses a publisher that appears in the moment of subscribing
    with TcpBoard(port, publishers=(text,)) as board:
        server.wait_for("/text (std_msgs/String) joined")

        def is_heard() -> bool:
            board.send(encode(126, struct.pack("<I", 65_531) + b"x" * 65_531))
            return "x" * 65_531 in shown.output

        until(is_heard)


@pytest.mark.slow
def test_commands_do_not_pile_up_on_their_way_to_a_board_that_is_busy(
    ids: IdService, server: Program, port: int, start: Start
) -> None:
    with TcpBoard(port) as board:
        server.wait_for("/Robot0/command")
        until(lambda: board.frames)
        with board.busy():
            flood = ("publish", "/Robot0/command", "0", "5000", "1", "0", "0")
            start("tests.integration.robot.peers", *flood).wait_for("published")
        until(lambda: board.commands()[-1:] == [bytes(3)])
        assert len(board.commands()) < 500


def test_the_serial_node_alone_serves_one_board_after_the_other_as_rosserial_python_does_with_tcp(
    start: Start, port: int
) -> None:
    node = start("robot.serial_node", "tcp", "_tcp_port:=" + str(port), "__name:=Robot61", "command:=/Robot61/command")
    start("tests.integration.robot.peers", "publish", "/Robot61/command", "0.1", "100000", "1", "0", "0")

    def serves_a_board(before: int) -> None:
        until(lambda: node.output.count(f"waiting for a board on port {port}") == before + 1)
        with TcpBoard(port) as board:
            until(lambda: b"\1\0\0" in board.commands(), 30)

    serves_a_board(0)
    serves_a_board(1)
    node.wait_for("the board has closed its connection")
    until(lambda: node.output.count(f"waiting for a board on port {port}") == 3)
    assert node.stop(signal.SIGTERM) == 0
    assert "Traceback" not in node.output


def test_the_next_board_does_not_wait_for_a_ros_master_that_hangs(
    ros_master: RosMaster, start: Start, port: int
) -> None:
    node = start("robot.serial_node", "tcp", str(port), "__name:=Robot62")
    begins = "laser_bot_battle.priority: "
    node.wait_for(f"waiting for a board on port {port}")
    with TcpBoard(port):
        node.wait_for("/Robot62 serves")
        ros_master.pause()
    try:
        until(lambda: node.output.count(begins) == 2)
    finally:
        ros_master.resume()
    until(lambda: node.output.count(f"waiting for a board on port {port}") == 2)


@pytest.mark.slow
def test_who_does_not_speak_rosserial_is_sent_away(ids: IdService, server: Program, port: int) -> None:
    with TcpBoard(port, answers=False) as silent:
        until(lambda: silent.closed, ANSWER_TIMEOUT + 10)
    assert "no answer to the topic request within 15 s (nothing came at all" in server.output
    assert ids.callers == []


def test_one_machine_has_so_many_places_and_no_more(server: Program, port: int) -> None:
    with contextlib.ExitStack() as stack:
        boards = [stack.enter_context(TcpBoard(port, answers=False)) for _ in range(MAX_OF_ONE_MACHINE + 1)]
        until(lambda: boards[-1].closed)
        assert not [board for board in boards[:-1] if board.closed]
        server.wait_for(f"refused a board at 127.0.0.1: {MAX_OF_ONE_MACHINE} boards")
        server.stop()


@pytest.mark.slow
def test_a_board_that_was_reset_is_the_same_robot_again(
    ids: IdService, web: WebServer, server: Program, port: int
) -> None:
    first = socket.create_connection(("127.0.0.1", port), 10)
    with first:
        assert first.recv(8)
        first.sendall(
            encode(0, TopicInfo(125, "response", "std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e", 280).encode())
        )
        until(lambda: "ID=0" in pinged(web))
        with TcpBoard(port):
            # as the kernel of a board that was reset answers to what belongs to its earlier connection
            first.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            first.close()
            until(lambda: len(ids.callers) == 2)
    assert ids.callers == ["/id_service_client_board_127_0_0_1"] * 2


def test_a_port_that_is_taken_is_said(settings: dict[str, str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        env = {**settings, "LASERBOT_SERIAL": f"tcp-listen://127.0.0.1:{port}"}
        server = Program.python("robot.id_service_client", env=env)
        assert server.exit_code() == 1
    assert f"cannot listen for boards on port {port}: Address already in use" in server.output


@pytest.mark.parametrize("value", ["tcp-listen://", "tcp-listen://:0", "tcp-listen://:11411 /dev/ttyACM0"])
def test_a_wrong_address_is_said(value: str) -> None:
    server = Program.python("robot.id_service_client", env={"LASERBOT_SERIAL": value})
    assert server.exit_code() == 2
    assert server.output.endswith("must be tcp-listen://address:port alone, such as tcp-listen://:11411\n")
