"""Starting, ending, and what the program says when something is in the way."""

import signal
import socket

import pytest
import requests

from tests.support.polling import LATEST, until
from tests.support.ports import listening
from tests.support.programs import Program


@pytest.mark.parametrize("sig", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(server, sig):
    server.robot("a")
    ada = server.player("ada")
    server.program.process.send_signal(sig)
    until(lambda: not listening(server.port), 2, "nobody can connect")  # somebody tries to all the time
    assert server.program.stop(sig, seconds=2) == 0
    assert "Traceback" not in server.program.output
    ada.close()


def test_it_waits_for_the_master_and_serves_only_then(launch, own_master):
    server = launch(master=own_master)
    server.program.wait_for("waiting; start roscore")
    assert not listening(server.port)
    own_master.start()
    server.wait_until_serving()
    assert server.post("getAvailableRobots") == {"availableR": 0, "message": "", "robots": [], "status": "OK"}


def test_it_can_be_ended_while_it_waits_for_the_master(launch, own_master):
    server = launch(master=own_master)
    server.program.wait_for("waiting; start roscore")
    assert server.program.stop(signal.SIGTERM) == 0
    assert "Traceback" not in server.program.output


def test_a_restarted_master_makes_it_begin_anew(launch, own_master):
    own_master.start()
    server = launch(master=own_master)
    server.wait_until_serving()
    own_master.stop()
    own_master.start()
    until(lambda: server.program.output.count("serving the game at") == 2, 10, "the second beginning")
    assert "the ROS master was restarted" in server.program.output
    assert "Traceback" not in server.program.output
    assert server.robot("a").id == 0
    assert server.program.stop(signal.SIGTERM) == 0


def test_a_second_server_of_the_same_name_replaces_the_first(launch):
    first = launch()
    first.wait_until_serving()
    second = launch()
    second.wait_until_serving()
    assert until(lambda: not first.program.running, 10)
    assert first.program.process.returncode == 1
    assert "Traceback" not in first.program.output
    assert second.robot("a").id == 0


def test_a_port_in_use_is_one_clear_line(launch):
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        server = launch(LASERBOT_WEB_PORT=str(port))
        assert server.program.exit_code() == 1
    lines = server.program.output.splitlines()
    assert len(lines) == 1
    assert f"cannot listen on 127.0.0.1 port {port}" in lines[0]
    assert "LASERBOT_WEB_PORT" in lines[0]


def test_an_impossible_setting_is_one_clear_line(launch):
    server = launch(LASERBOT_COUNTDOWN="soon")
    assert server.program.exit_code() == 2
    assert server.program.output.splitlines() == [
        "server.main: LASERBOT_COUNTDOWN=soon: must be a number from 0.1 to 3600"
    ]


def test_help_is_given_without_a_master():
    program = Program.python("server.main", "--help", env={"PYTHONPATH": ".:build/python"})
    assert program.exit_code() == 0
    assert "game server" in program.output


def test_arguments_of_roslaunch_are_no_error_and_others_are():
    env = {"PYTHONPATH": ".:build/python", "LASERBOT_COUNTDOWN": "x"}
    launched = Program.python("server.main", "__name:=robots_server", "__log:=/dev/null", env=env)
    assert launched.exit_code() == 2
    assert "LASERBOT_COUNTDOWN=x" in launched.output
    wrong = Program.python("server.main", "--nonsense", env=env)
    assert wrong.exit_code() == 2
    assert "--nonsense" in wrong.output


def test_slow_clients_do_not_hold_up_the_others(server):
    stalled = [socket.create_connection(("127.0.0.1", server.port), 5) for _ in range(60)]
    try:
        for client in stalled:
            client.sendall(b"POST /signUpUser HTTP/1.1\r\nHost: x\r\nContent-Length: 100\r\n\r\ndata=")
        response = requests.post(f"{server.url}/getAvailableRobots", timeout=LATEST)
        assert response.json()["status"] == "OK"
        response.close()
    finally:
        for client in stalled:
            client.close()
