"""Robots register by the real service and keep their IDs."""

import json
import socket
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from urllib.parse import urlsplit
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from laser_bot_battle.addresses import own_addresses
from laser_bot_battle.master import Master
from tests.support.polling import until


def available(server) -> int:
    return server.post("getAvailableRobots")["availableR"]


def kept(tmp_path) -> dict[str, int]:
    """The IDs in the database, as soon as there are any."""

    def read() -> dict[str, int]:
        with closing(sqlite3.connect(tmp_path / "data" / "laserbot.db")) as database:
            return dict(database.execute("SELECT caller, robot FROM robots").fetchall())

    return until(read, 5)


def test_robots_get_the_lowest_free_ids_and_are_available_soon_after_they_are_on_their_topics(server):
    assert available(server) == 0
    assert [server.robot(name).id for name in ("a", "b", "-")] == [0, 1, 2]
    until(lambda: available(server) == 2, 3)
    assert server.post("signUpUser", data="cy", robot=2)["status"] == "ROBOT_UNAVAILABLE", "no node drives it"


def test_a_robot_gets_its_id_back_after_a_restart_of_the_server(server, tmp_path):
    first, second = server.robot("a"), server.robot("b")
    assert (first.id, second.id) == (0, 1)
    until(lambda: kept(tmp_path) == {"/id_service_client_a": 0, "/id_service_client_b": 1}, 5)
    first.vanish()
    server.program.kill()
    server.launch()
    server.wait_until_serving()
    until(lambda: available(server) == 1, 10, "the other one is still there")
    assert second.id == 1
    assert server.robot("a").id == 0


@pytest.mark.slow
def test_a_robot_that_restarts_at_once_keeps_its_player(server):
    first = server.robot("a")
    ada = server.player("ada")
    first.vanish()
    again = server.robot("a")
    assert again.id == 0
    assert available(server) == 0
    assert json.loads(ada.post("updateGameStatus")["users"])[0]["name"] == "ada"


@pytest.mark.slow
def test_two_original_clients_get_two_ids_and_keep_them_whatever_address_of_the_machine_they_use(launch):
    """They register at the address that ROS tells, and ping the one that they were given."""
    others = sorted(address for address in own_addresses() if not address.startswith("127."))
    if not others:
        pytest.skip("this machine has no other address than 127.0.0.1")
    server = launch(ROS_HOSTNAME=others[0])
    server.wait_until_serving()
    for robot_id in (0, 1):
        robot = server.peer("original", server.url)
        robot.wait_for(f"registered {robot_id}", 15)
        until(lambda robot_id=robot_id: server.is_linked(robot_id), 10)
        began = time.monotonic()
        until(lambda began=began: time.monotonic() > began + 5, 10, "longer than a silent robot is kept")
    assert available(server) == 2
    assert "gone" not in server.program.output


@pytest.mark.slow
def test_the_ids_that_an_older_version_has_kept_in_a_file_are_taken_over_once(launch, tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "robots.json").write_text('{"/id_service_client_a": 7}')
    server = launch()
    server.wait_until_serving()
    assert server.robot("b").id == 0
    assert (tmp_path / "data" / "robots.json.imported").exists()
    server.program.kill()
    server.launch()
    server.wait_until_serving()
    assert server.robot("a").id == 7


def test_an_id_that_the_operator_fixed_is_reserved_for_its_robot(launch, tmp_path):
    server = launch(LASERBOT_ROSTER="a=0")
    server.wait_until_serving()
    assert server.robot("b").id == 1
    assert server.robot("a").id == 0


def test_a_robot_that_seems_to_be_a_fixed_one_is_told_how_to_become_it(launch):
    server = launch(LASERBOT_ROSTER="a=0")
    server.wait_until_serving()
    assert server.robot("a_b8_27_eb_00_00_01").id == 1
    until(lambda: "set LASERBOT_ROBOT_NAME=a on it" in server.program.output)


def test_a_broken_file_of_ids_is_kept_aside_and_robots_start_afresh(launch, tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "robots.json").write_text('{"/id_service_client_a": ')
    server = launch()
    server.wait_until_serving()
    assert "robots.json is broken" in server.program.output
    assert server.robot("b").id == 0
    assert kept(tmp_path) == {"/id_service_client_b": 0}
    assert (tmp_path / "data" / "robots.json.broken").exists()


@pytest.mark.slow
def test_the_129th_robot_is_refused_in_words(server):
    crowd = server.peer("crowd")
    text = crowd.wait_for("refused after", 30)
    ids, error = json.loads(text[text.index("[") : text.index("]") + 1]), text
    assert ids == list(range(128))
    assert "no ID left" in error
    assert available(server) == 0
    assert "Traceback" not in server.program.output


def test_a_silent_robot_is_removed_and_its_subscription_with_it(server):
    robot = server.robot("a")
    robot.vanish()
    until(lambda: available(server) == 0, 6)
    until(lambda: "robot 0 is gone" in server.program.output)
    assert server.post("incAlive", ID=0) == {"status": "ERROR"}


@pytest.mark.slow
def test_peers_that_stall_while_greeting_hold_up_nobody_and_are_cut_off(server, ros_master):
    service = Master(ros_master.uri, "/test").call("lookupService", "/add_new_robot")
    place = urlsplit(service)
    stalled = [socket.create_connection((place.hostname, place.port), 10) for _ in range(3)]
    try:
        stalled[0].sendall(b"POST / HTTP/1.1\r\n")  # which says: a greeting of 1.4 GB
        stalled[1].sendall(b"\x10\x00")
        assert server.robot("a").id == 0
        assert [is_cut_off(client) for client in stalled] == [True] * 3
    finally:
        for client in stalled:
            client.close()
    assert "Traceback" not in server.program.output


def is_cut_off(client: socket.socket) -> bool:
    """By a reset when the server has left some of it unread."""
    try:
        return client.recv(1) == b""
    except ConnectionResetError:
        return True


@contextmanager
def busy_node(ros_master, topic: str, message_type: str) -> Iterator[list[str]]:
    """A node that publishes on `topic`, but cannot answer who asks for it; yields the names of those who have."""
    asked: list[str] = []

    def request_topic(*call: object) -> tuple[int, str, int]:
        asked.append(str(call[0]))
        return 0, "not now", 0

    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False, allow_none=True) as node:
        node.register_function(request_topic, "requestTopic")
        thread = threading.Thread(target=node.serve_forever)
        thread.start()
        master = Master(ros_master.uri, "/busy_robot")
        uri = f"http://127.0.0.1:{node.server_address[1]}"
        master.call("registerPublisher", topic, message_type, uri)
        try:
            yield asked
        finally:
            master.call("unregisterPublisher", topic, uri)
            node.shutdown()
            thread.join()


def test_a_robot_that_did_not_answer_at_once_is_asked_for_its_hits_again(server, ros_master):
    robot = server.robot("-")
    with busy_node(ros_master, f"/Robot{robot.id}/response", "std_msgs/Empty") as asked:
        until(lambda: asked.count("/robots_server") >= 2, 10, "the server asks again")


def test_a_rosbridge_that_did_not_answer_at_once_is_asked_for_its_shots_again(server, ros_master):
    with busy_node(ros_master, "/shots", "laser_bot_battle/Shot") as asked:
        until(lambda: asked.count("/robots_server") >= 2, 10, "the server asks again")
