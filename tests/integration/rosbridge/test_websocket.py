"""The WebSocket server, seen from real sockets: handshake, limits, turns, and clients that are slow, rude or dead."""

import asyncio
import itertools
import logging
import os
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from ipaddress import ip_network

import psutil
import pytest
import uvloop
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.connection import Connection
from websockets.typing import Subprotocol

from laser_bot_battle.listening import Listener
from server.websocket import connection as module
from server.websocket import server as server_module
from server.websocket.limits import Limits
from server.websocket.server_state import MAX_LINES_OF_ADDRESS, MAX_LOG_LINES
from tests.integration.rosbridge.echo import EchoServer, LoopFactory
from tests.integration.rosbridge.mute import MuteClient
from tests.support import bare
from tests.support.bare import BareClient
from tests.support.polling import until

LOOPS: dict[str, LoopFactory] = {"asyncio": asyncio.new_event_loop, "uvloop": uvloop.new_event_loop}
HANDSHAKE = (
    "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: keep-alive, Upgrade\r\nUpgrade: websocket\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
)
PING = b"\x89\x80\x00\x00\x00\x00"
EMPTY_PART = b"\x00\x80\x00\x00\x00\x00"
MIB = 2**20


@pytest.fixture(params=list(LOOPS.values()), ids=list(LOOPS))
def loop_factory(request: pytest.FixtureRequest) -> LoopFactory:
    factory: LoopFactory = request.param
    return factory


@pytest.fixture
def echo(loop_factory: LoopFactory) -> Iterator[EchoServer]:
    with EchoServer(loop_factory) as server:
        yield server
    assert sorted(server.bridge.went) == sorted(server.bridge.came), "each client that came went once"


def answer(rude: socket.socket) -> str:
    """All that comes until the end."""
    data = b""
    with rude:
        while part := rude.recv(65536):
            data += part
    return data.decode()


def end_of(client: Connection) -> tuple[int, str]:
    """The close frame that comes, after whatever else."""
    with pytest.raises(ConnectionClosed) as closed:
        while True:
            client.recv(10)
    assert closed.value.rcvd is not None, closed.value
    return closed.value.rcvd.code, closed.value.rcvd.reason


def resident() -> int:
    return int(psutil.Process(os.getpid()).memory_info().rss)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody wants to wait for the real time-outs."""
    monkeypatch.setattr(module, "STALL", 0.5)
    monkeypatch.setattr(module, "PING_INTERVAL", 0.5)
    monkeypatch.setattr(server_module, "OPEN_TIMEOUT", 0.5)
    monkeypatch.setattr(server_module, "TICK", 0.1)


def test_messages_of_every_size_come_back(echo: EchoServer) -> None:
    with echo.client("operator") as client:
        for size in (0, 1, 125, 126, 65535, 65536, 8 * MIB):
            for data in ("x" * size, b"\xff" * size):
                client.send(data)
                assert client.recv() == data
        client.send(["Grü", "", "ße"])
        assert client.recv() == "Grüße"
        assert client.ping("there?").wait(5)


def test_what_comes_with_the_handshake_is_not_lost(echo: EchoServer) -> None:
    with echo.raw() as client:
        text = b"\x81\x82\x00\x00\x00\x00hi"
        for part in (HANDSHAKE[:30].encode(), HANDSHAKE[30:].encode() + text + text[:3], text[3:]):
            client.sendall(part)
        heard = b""
        while heard.count(b"\x81\x02hi") < 2:
            heard += client.recv(4096)
    assert b"Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n" in heard  # RFC 6455 1.3


@pytest.mark.parametrize(
    ("request_", "status"),
    {
        "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n": 426,
        HANDSHAKE.replace("Version: 13", "Version: 8"): 400,
        HANDSHAKE.replace("dGhl", "\udcff\udcfe"): 400,
        HANDSHAKE.replace("\r\n\r\n", "\r\nOrigin: http://a\r\nOrigin: http://b\r\n\r\n"): 400,
        HANDSHAKE.replace("GET", "POST"): 400,
        "\r\n\r\n": 400,
        "\x16\x03\x01" * 6000: 400,
        "GET / HTTP/1.1\r\nCookie: " + "x" * 20000: 400,
    }.items(),
    ids=["health check", "version", "key", "two origins", "POST", "empty", "TLS", "endless"],
)
def test_what_is_no_handshake_is_refused(
    echo: EchoServer, request_: str, status: int, caplog: pytest.LogCaptureFixture
) -> None:
    rude = echo.raw()
    rude.sendall(request_.encode(errors="surrogateescape"))
    reply = answer(rude)
    assert reply.startswith(f"HTTP/1.1 {status} ")
    assert ("\r\nUpgrade: websocket\r\n" in reply) == (status == 426)
    assert not [record for record in caplog.records if record.exc_info]
    assert not echo.bridge.came


@pytest.mark.parametrize(
    ("offers", "chosen"),
    [
        ([], None),
        (["v1.rosbridge.example"], "v1.rosbridge.example"),
        (["b, a", "c"], "b"),
        (["a b,, \t~!x , c"], "~!x"),  # no name has spaces
        (["", "wamp/2, \u0441"], None),
        (["a, a"], "a"),
    ],
)
def test_of_sub_protocols_a_client_gets_the_first_that_can_be_one(
    echo: EchoServer, offers: list[str], chosen: str | None
) -> None:
    offered = "".join(f"Sec-WebSocket-Protocol: {offer}\r\n" for offer in offers)
    with echo.raw() as client:
        client.sendall(HANDSHAKE.replace("Upgrade: websocket\r\n", f"Upgrade: websocket\r\n{offered}").encode())
        heard = b""
        while b"\r\n\r\n" not in heard:
            heard += client.recv(4096)
    status, *headers = heard.decode().split("\r\n")
    assert status.startswith("HTTP/1.1 101 ")
    told = [header.partition(": ")[2] for header in headers if header.lower().startswith("sec-websocket-protocol:")]
    assert told == ([chosen] if chosen else [])


def test_a_client_that_wants_a_sub_protocol_is_content(echo: EchoServer) -> None:
    with echo.client(subprotocols=[Subprotocol("rosbridge"), Subprotocol("other")]) as client:
        client.send("hello")
        assert (client.recv(), client.subprotocol) == ("hello", "rosbridge")


def test_a_visitor_by_ipv4_has_the_places_of_that_address_wherever_it_is_accepted(loop_factory: LoopFactory) -> None:
    """A socket for both families calls it ::ffff:127.0.0.1."""
    both = Listener(socket.create_server(("::", 0), family=socket.AF_INET6, dualstack_ipv6=True))
    with EchoServer(loop_factory, listener=both) as echo, echo.client() as client:
        client.send("hello")
        assert client.recv() == "hello"
        assert [name.rpartition(":")[0] for name in echo.bridge.came] == ["127.0.0.1"]


def test_what_a_believed_proxy_was_asked_for_counts_and_what_others_say_does_not(loop_factory: LoopFactory) -> None:
    with EchoServer(loop_factory, proxies=[ip_network("127.0.0.2")]) as echo:
        own = f"127.0.0.1:{echo.port}"
        for source, told, authority in (
            ("127.0.0.2", {"X-Forwarded-Host": "arena.example:8443"}, "arena.example:8443"),
            ("127.0.0.2", {"X-Forwarded-Host": "forged.example, arena.example"}, "arena.example"),
            ("127.0.0.2", {"X-Forwarded-Host": "arena.example", "X-Forwarded-Proto": "https"}, "arena.example:443"),
            ("127.0.0.2", {"X-Forwarded-Host": "arena.example", "X-Forwarded-Proto": "wss"}, "arena.example:443"),
            ("127.0.0.2", {"X-Forwarded-Host": "no host"}, own),
            ("127.0.0.2", {}, own),
            ("127.0.0.3", {"X-Forwarded-Host": "arena.example", "X-Forwarded-Proto": "https"}, own),
        ):
            echo.client(source=source, headers=told).close()
            assert echo.asked[-1] == authority, (source, told)


def test_everybody_has_places_and_a_full_server_is_alive(loop_factory: LoopFactory) -> None:
    limits = Limits(clients=6, kept=2, guests=3, player=1)

    with EchoServer(loop_factory, limits) as echo, ExitStack() as stack:

        def refused(cookie: str = "", source: str = "127.0.0.1") -> bool:
            with pytest.raises(InvalidStatus) as error:
                echo.client(cookie, source)
            return error.value.response.status_code == 503

        guests = [stack.enter_context(echo.client()) for _ in range(3)]
        assert refused()
        stack.enter_context(echo.client(source="127.0.0.2"))
        assert refused(source="127.0.0.3")
        stack.enter_context(echo.client("player al"))
        assert refused("player al")
        stack.enter_context(echo.client("operator"))
        assert refused("operator")
        health = echo.raw("127.0.0.4")
        health.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert answer(health).startswith("HTTP/1.1 426 ")
        guests[0].close()
        until(lambda: echo.bridge.went)
        stack.enter_context(echo.client())
        guests[1].send("promote")
        guests[1].send("x" * 100_000)
        assert len(guests[1].recv()) == 100_000
        guests[2].send("x" * 100_000)
        assert end_of(guests[2])[0] == 1009


def test_a_socket_without_handshake_costs_its_address_a_place_for_a_while(
    loop_factory: LoopFactory, quick: None
) -> None:
    with EchoServer(loop_factory, Limits(opening=2, all_opening=3)) as echo, ExitStack() as stack:
        silent = [stack.enter_context(echo.raw()) for _ in range(2)]
        silent[0].sendall(b"GET ")
        assert cut(stack.enter_context(echo.raw()))
        others = [stack.enter_context(echo.raw("127.0.0.2")) for _ in range(2)]
        assert cut(silent[0]), "the oldest gives way"
        assert all(cut(each) for each in (silent[1], *others))
        stack.enter_context(echo.client())


def cut(client: socket.socket) -> bool:
    try:
        return client.recv(1) == b""
    except ConnectionResetError:
        return True


@pytest.mark.parametrize(
    ("data", "code"),
    {
        b"\x81\x05Hello": 1002,
        b"\x81\x81\x00\x00\x00\x00\xff": 1007,
        b"\x81\xff" + (2**63).to_bytes(8, "big") + bytes(4): 1009,
        b"\x01\x80\x00\x00\x00\x00" + EMPTY_PART * 100_000: 1008,
        PING * 100_000: 1008,
    }.items(),
    ids=["not masked", "UTF-8", "long", "parts", "pings"],
)
def test_who_breaks_the_rules_hears_why(echo: EchoServer, data: bytes, code: int) -> None:
    with echo.client() as client:
        with suppress(BrokenPipeError, ConnectionResetError):
            client.socket.sendall(data)
        assert end_of(client)[0] == code


def test_a_failure_ends_the_connection_that_caused_it(echo: EchoServer, caplog: pytest.LogCaptureFixture) -> None:
    with echo.client() as other, echo.client() as client:
        client.send("fail")
        assert end_of(client)[0] == 1011
        other.send("still here")
        assert other.recv() == "still here"
    assert [record.message for record in caplog.records if record.exc_info]


def test_the_bridge_and_the_client_may_end_it(echo: EchoServer) -> None:
    with BareClient(echo.port) as bare_client:
        bare_client.send(bare.frame("close 4001") + bare.frame("too late"))
        assert bare_client.hear_frame() == (bare.CLOSE, (4001).to_bytes(2) + b"as you like")
    with echo.client() as client:
        client.close(1000)
        assert client.close_code == 1000
    assert echo.bridge.received_bytes == len("close 4001")


def test_at_the_end_all_are_told_and_nobody_holds_it_up(loop_factory: LoopFactory) -> None:
    with EchoServer(loop_factory) as echo, echo.client() as client, MuteClient(echo.port), echo.raw():
        for _ in range(3):  # asyncio itself forgets a socket that it accepts at the very moment of its end
            client.send("are all known?")
            client.recv(5)
        echo.stop()
        assert end_of(client)[0] == 1001
        assert len(echo.bridge.went) == 2


def test_a_client_that_has_just_gone_can_be_closed(echo: EchoServer) -> None:
    """Its end has come, and has not been read yet; the kernel then answers what is sent with a reset."""
    with echo.raw() as client:
        client.sendall(HANDSHAKE.encode())
        assert client.recv(4096).startswith(b"HTTP/1.1 101 ")
        closed = threading.Event()

        def go_and_close() -> None:
            client.close()
            echo.bridge.newest.close(1001)
            closed.set()

        echo.in_loop(go_and_close)
        assert closed.wait(5)
    until(lambda: echo.bridge.went == echo.bridge.came)


def test_who_floods_does_not_keep_the_others_waiting(echo: EchoServer) -> None:
    """Two guests have sent thousands of messages, and a player one, before the server looks at any of them."""
    flood = b"\x81\x82\x00\x00\x00\x00hi" * 3000
    with echo.raw() as one, echo.raw() as two, echo.client("player al") as driver:
        for guest in (one, two):
            guest.sendall(HANDSHAKE.encode())
            assert guest.recv(4096).startswith(b"HTTP/1.1 101 ")
        held = threading.Event()

        def hold() -> None:
            held.set()
            time.sleep(0.5)  # all of it has come then

        echo.in_loop(hold)
        assert held.wait(5)
        for guest in (one, two):
            guest.sendall(flood)
        driver.send("command")
        assert driver.recv(5) == "command"
        until(lambda: len(echo.bridge.order) == 6001)
        driver_name = f"127.0.0.1:{driver.local_address[1]}"
    runs = [(name, len(list(run))) for name, run in itertools.groupby(echo.bridge.order)]
    assert sum(length for name, length in runs[: runs.index((driver_name, 1))]) <= 48
    both = [length for name, length in runs[: len(runs) // 2]]
    assert max(both) <= 32, "the guests take turns as well"


def test_a_burst_of_messages_is_answered_whole_and_in_order(echo: EchoServer) -> None:
    with echo.client("player al") as client:
        for number in range(5000):
            client.send(f"{number}")
        assert [client.recv(5) for _ in range(5000)] == [str(number) for number in range(5000)]


def test_who_reads_slowly_gets_the_newest_in_the_end(echo: EchoServer) -> None:
    with echo.client("operator", max_queue=(4, 1)) as client:
        client.send("repeat 3000 10000 5")
        time.sleep(0.5)  # it does not read: what this is about
        numbers = []
        while (text := client.recv(5)) != "done":
            numbers.append(int(str(text).split()[0]))
        assert numbers == sorted(set(numbers))
        assert numbers[-5:] == [2995, 2996, 2997, 2998, 2999]
        assert len(numbers) < 2900


@pytest.mark.slow
@pytest.mark.parametrize(
    ("requests", "reason"),
    [
        (["x" * 30_000] * 1000, "it does not read what it has asked for"),
        (["repeat 1000 100000 1000"], "it has not read for 5 s"),
    ],
    ids=["replies", "messages"],
)
def test_who_does_not_read_is_given_up(
    echo: EchoServer, requests: list[str], reason: str, caplog: pytest.LogCaptureFixture
) -> None:
    before = resident()
    with MuteClient(echo.port) as mute:
        with suppress(OSError):
            for request in requests:
                mute.send(request)
        until(lambda: mute.given_up, 15)
    until(lambda: echo.bridge.went)
    assert resident() - before < 30 * MIB
    given = [record.message.partition(": ")[2] for record in caplog.records if "given up" in record.message]
    assert given[:1] == [f"given up, {reason}"]


def test_who_takes_nothing_for_long_is_given_up(
    loop_factory: LoopFactory, quick: None, caplog: pytest.LogCaptureFixture
) -> None:
    with EchoServer(loop_factory) as echo, MuteClient(echo.port) as mute:
        mute.send("repeat 100 10000 1")
        until(lambda: echo.bridge.went, 5)
    assert "it has not read for" in caplog.text


def test_a_dead_line_is_noticed(loop_factory: LoopFactory, quick: None, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    with EchoServer(loop_factory) as echo, MuteClient(echo.port):
        until(lambda: echo.bridge.went, 5)
    assert "nothing was heard of it" in caplog.text


def test_an_operator_may_be_silent_for_longer(
    loop_factory: LoopFactory, quick: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "PING_INTERVAL_OF_OPERATORS", 1.5)
    with EchoServer(loop_factory) as echo, MuteClient(echo.port) as operator, MuteClient(echo.port) as guest:
        operator.send("promote")
        until(lambda: len(echo.bridge.went) == 2)
        assert echo.bridge.went == [guest.name, operator.name]


@pytest.mark.slow
def test_a_server_that_stood_still_gives_nobody_up(loop_factory: LoopFactory, quick: None) -> None:
    with EchoServer(loop_factory) as echo, BareClient(echo.port) as client:
        echo.in_loop(lambda: time.sleep(1.5))  # three times as long as a client may be silent
        for _ in range(3):
            assert client.hear_frame() == (bare.PING, b"")
            client.send(bare.frame(b"", bare.PONG))
        client.send(bare.frame("still here"))
        assert client.hear_frame() == (bare.TEXT, b"still here")


def test_pings_that_nobody_reads_the_answers_of_cost_no_memory(echo: EchoServer) -> None:
    before = resident()
    long_ping = b"\x89\xfd\x00\x00\x00\x00" + bytes(125)
    with MuteClient(echo.port) as mute:
        for _ in range(10):
            until(lambda: sent_slowly(mute, long_ping * 40))
    assert resident() - before < 10 * MIB


def sent_slowly(mute: MuteClient, data: bytes) -> bool:
    mute._socket.sendall(data)
    time.sleep(0.1)  # slower than what is too many
    return True


def test_the_log_is_not_filled_by_who_comes_and_goes(echo: EchoServer, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "server")
    begin = time.monotonic()
    for _ in range(300):
        with echo.raw() as rude:
            rude.sendall(HANDSHAKE.encode())
            assert rude.recv(4096)
    with echo.raw("127.0.0.2") as another:
        another.sendall(HANDSHAKE.encode())
        assert another.recv(4096)
        until(lambda: "127.0.0.2" in caplog.text)
    lines = [record for record in caplog.records if "connected" in record.message]
    assert 0 < len(lines) <= MAX_LINES_OF_ADDRESS * (time.monotonic() - begin + 1) + 1


def test_the_log_is_not_filled_by_many_either(echo: EchoServer, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "server")
    begin = time.monotonic()
    for number in range(200):
        with echo.raw(f"127.0.1.{number + 1}") as rude:
            rude.sendall(HANDSHAKE.encode())
            assert rude.recv(4096)
    until(lambda: len(echo.bridge.went) == 200)
    lines = [record for record in caplog.records if "connected" in record.message]
    assert 0 < len(lines) <= MAX_LOG_LINES * (time.monotonic() - begin + 1)
