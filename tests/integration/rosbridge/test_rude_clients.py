"""Clients that send nonsense, too much, or do not read: they cost the others nothing."""

import json
import socket
import time
from collections.abc import Callable

import psutil
import pytest
from websockets.exceptions import ConnectionClosed

from server.websocket.server_state import MAX_LINES_OF_ADDRESS
from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import FORWARD, NEUTRAL, Client, RosSide, player
from tests.integration.rosbridge.mute import MuteClient
from tests.support.bare import BareClient
from tests.support.polling import until

Connect = Callable[..., Client]


RUBBISH = {
    "list": "[1, 2]",
    "null": "null",
    "string": '"op"',
    "quotes": "{'op': 1}",
    "NaN": '{"op": NaN}',
    "deep": "[" * 60000,
    "binary": b"\x00\xff\x17",
    "binary JSON": b'{"op": "subscribe"}',
}


@pytest.mark.parametrize("rubbish", RUBBISH.values(), ids=RUBBISH)
def test_rubbish_gets_an_error_and_the_connection_stays(client: Connect, rubbish: str | bytes) -> None:
    rude = client()
    rude.socket.send(rubbish)
    rude.hear_error()
    goes_on(rude)


@pytest.mark.parametrize("beginning", ["", "{", "\ufeff", '{"op": "publish", "topic": "/cut'])
def test_what_comes_behind_nothing_or_half_a_request_is_heard(client: Connect, beginning: str) -> None:
    rude = client()
    rude.socket.send(beginning)
    rude.say("status", level="info", msg="it is me")
    if "{" in beginning:
        assert "skipped" in rude.hear_error()
    goes_on(rude)


def goes_on(rude: Client) -> None:
    rude.operate().say("advertise", topic="/rude", type="std_msgs/String", latch=True)
    rude.say("subscribe", topic="/rude", type="std_msgs/String")
    rude.say("publish", topic="/rude", msg={"data": "still here"})
    assert rude.hear()["msg"] == {"data": "still here"}


def test_a_message_that_is_too_long_closes_the_connection_with_1009(client: Connect) -> None:
    rude = client()
    rude.socket.send(json.dumps({"op": "status", "level": "info", "msg": "x" * 70000}))
    with pytest.raises(ConnectionClosed) as closed:
        rude.hear()
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1009


@pytest.mark.slow
def test_what_is_no_websocket_is_turned_away(rosbridge: Rosbridge, client: Connect) -> None:
    for rubbish in (b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", b"\x16\x03\x01\x02\x00\x01" * 50, b"\r\n\r\n"):
        with socket.create_connection(("127.0.0.1", rosbridge.port), 5) as rude:
            rude.sendall(rubbish)
            rude.settimeout(10)
            while rude.recv(4096):
                pass
    client().say("subscribe", topic="/game_status")


def test_the_log_is_not_flooded(rosbridge: Rosbridge, client: Connect) -> None:
    rude = client()
    before = len(rosbridge.program.output.splitlines())
    for _ in range(500):
        rude.socket.send('{"op": rubbish}')
    for _ in range(500):
        rude.hear_error()
    assert len(rosbridge.program.output.splitlines()) - before < 50


def test_who_comes_and_goes_does_not_flood_the_log_either(rosbridge: Rosbridge) -> None:
    def lines() -> int:
        return len(rosbridge.program.output.splitlines())

    before, begin = lines(), time.monotonic()
    for _ in range(100):
        with BareClient(rosbridge.port) as rude:
            for _ in range(5):
                rude.say("status", level="info", msg="it is me")
            rude.say("nonsense")
            rude.hear()
    summaries = 10  # of what was left out
    assert lines() - before <= MAX_LINES_OF_ADDRESS * (time.monotonic() - begin + 1) + summaries


@pytest.mark.slow
def test_a_silent_line_stops_the_robot_and_is_closed(rosbridge: Rosbridge, ros: RosSide) -> None:
    """Half-open: the browser's machine has lost its network, no FIN ever comes."""
    ros.listen("/Robot4/command")
    with MuteClient(rosbridge.port, "token-of-di") as di:

        def arrives() -> bool:
            ros.status(2, player("di", "token-of-di", 4))
            di.say("publish", topic="/Robot4/command", msg=FORWARD)
            return FORWARD in ros.heard("/Robot4/command")

        until(arrives)

        def stopped() -> bool:
            ros.status(2, player("di", "token-of-di", 4))
            return ros.heard("/Robot4/command")[-1] == NEUTRAL

        until(stopped, 12, "a neutral command, and with it the end of the line")


@pytest.mark.slow
def test_a_client_that_does_not_read_delays_nobody_and_is_given_up(
    rosbridge: Rosbridge, ros: RosSide, client: Connect
) -> None:
    kilobytes = "x" * 50_000
    reader = client().operate()
    reader.say("subscribe", topic="/fat", type="std_msgs/String", queue_length=1000)
    memory = resident(rosbridge)
    with MuteClient(rosbridge.port) as mute:
        mute.say("auth", client="operator", mac="the operators' token")
        mute.say("subscribe", topic="/fat", type="std_msgs/String", queue_length=1000)

        def connected() -> bool:
            ros.publish("/fat", "std_msgs/String", data="first")
            return not reader.hears_nothing_for_now(0.1)

        until(connected)
        for number in range(400):
            ros.publish("/fat", "std_msgs/String", data=f"{number} {kilobytes}")
            while not reader.hear()["msg"]["data"].startswith(f"{number} "):
                pass
        until(lambda: mute.given_up, 15, "the end of the client that does not read")
    assert resident(rosbridge) - memory < 30 * 2**20


def test_a_client_that_asks_and_does_not_read_is_given_up(rosbridge: Rosbridge) -> None:
    with MuteClient(rosbridge.port) as mute:

        def given_up() -> bool:
            try:
                for _ in range(20):
                    mute.send('{"op": "nonsense", "id": "%s"}' % ("i" * 250))
            except OSError:
                return True
            return mute.given_up

        until(given_up, 15, "the end of the client that does not read")


def resident(rosbridge: Rosbridge) -> int:
    """Memory in bytes."""
    return int(psutil.Process(rosbridge.program.process.pid).memory_info().rss)
