"""Whatever a guest, a player and an operator send, rosbridge lives on, and ROS hears only what it may."""

import contextlib
import json
import os
import re
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import psutil
import pytest

from server.websocket.connection import CLOSE_TIMEOUT
from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import COMMAND_TYPE, FORWARD, STATUS_TYPE, Client, RosSide, player
from tests.integration.rosbridge.mutations import WRAPPERS, Mutation, mutation
from tests.integration.rosbridge.operations import OFFERED, OPERATIONS, Role
from tests.support.bare import CLOSE, PING, PONG, BareClient, frame
from tests.support.documents import page, table
from tests.support.polling import until
from tests.support.ros import RosMaster

COUNT = int(os.environ.get("FUZZ", "100000"))  # operations
SEED = int(os.environ.get("FUZZ_SEED", "1"))
AT_ONCE = 4  # operations that a client sends before it waits for their end
GROWTH = 40 * 2**20  # bytes of memory
STATUS_PERIOD = 0.4  # s
WARM_UP = 0.1  # of all operations: what is needed once is loaded, before memory is measured

OWN, OTHERS = "/Robot0/command", ("/Robot1/command", "/Robot3/command")
STATUS = ("/game_status", STATUS_TYPE)
NOT_THEIRS = tuple((topic, COMMAND_TYPE) for topic in OTHERS)
GUEST = Role("guest", (*NOT_THEIRS, (OWN, COMMAND_TYPE), STATUS, STATUS, STATUS), ("al", "bo", ""), ("x", "9.x"))
PLAYER = Role("player", (*NOT_THEIRS, *[(OWN, COMMAND_TYPE)] * 9, STATUS, STATUS), ("al", "bo"), ("of-al", "x"))
OPERATOR = Role("operator", (("/Robot77/command", COMMAND_TYPE),), ("nobody", ""), ("x",))
COOKIES = {"player": {"Cookie": "laserbot_session=of-al"}}

# no traceback, and nothing of a client's that would look like a line of its own or fill the log
LINE = re.compile(r"[-\d]{10} [:,\d]{12} (INFO|WARNING|ERROR) (server|laser_bot_battle|tcpros)\..{,500}")
QUESTION = b"are these handled?"
# of RFC 6455, 7.4.1, in answer to what a client may not send, and to its own end
REASONS = {1000, 1001, 1002, 1003, 1007, 1008, 1009, 3000}
REGISTERED = re.compile(r"\+(PUB|SUB|SERVICE) \[([^]]*)\] /rosbridge_websocket ")


class Fuzzer:
    """One client that sends mutations, a few at once; a ping after them tells when they are handled."""

    def __init__(self, port: int, role: Role, seed: int) -> None:
        self.role, self.number = role, 0
        self.connections = self.errors = self.successes = 0
        self._port, self._seed = port, seed
        self._call = "none"  # the newest that the server waits for
        self._sent: list[Mutation] = []
        self._client: BareClient | None = None

    def __str__(self) -> str:
        first = self.number - len(self._sent) + 1
        sent = (f"{number}: {made.said[:500]!r}" for number, made in enumerate(self._sent, first))
        return "\n".join((f"newest operations of the {self.role.name}, seed {self._seed}:", *sent))

    def metrics(self) -> str:
        return f"{self.role.name}: {self.connections} connections, {self.errors} errors, {self.successes} calls;"

    def connect(self) -> None:
        if self._client is None:
            self._client = self._connect()

    def send(self) -> None:
        """The next mutations."""
        assert self._client
        self._sent = []
        while len(self._sent) < AT_ONCE and (not self._sent or self._sent[-1].whole):
            self.number += 1
            self._sent.append(mutation(self._seed, self.role, self.number, self._call))
        data = b"".join(made.data for made in self._sent)
        self._sent_at = time.monotonic()
        with contextlib.suppress(OSError):  # it may be closed by one of them
            self._client.send(data + frame(QUESTION, PING))

    def settle(self) -> None:
        """Read until they are handled, or have ended the connection. AssertionError when they should not have."""
        assert self._client
        try:
            goes_on = self._sent[-1].whole and self._answered(self._client)
        except ConnectionResetError:  # the end was told, and not read in time: on a busy machine the others were slow
            assert time.monotonic() - self._sent_at >= CLOSE_TIMEOUT
            goes_on = False
        if not goes_on:
            self.close()

    def close(self) -> None:
        if self._client:
            self._client.close()
            self._client = None

    def _answered(self, client: BareClient) -> bool:
        """False when the server has closed the socket for a good reason."""
        while (heard := client.hear_frame()) != (PONG, QUESTION):
            opcode, payload = heard
            if opcode == PING:
                client.send(frame(payload, PONG))
            elif opcode == CLOSE:
                code = int.from_bytes(payload[:2], "big")
                assert code in REASONS, f"the {self.role.name} was closed with {code} {payload[2:]!r}"
                return False
            elif opcode != PONG:
                self._hear(payload)
        return True

    def _hear(self, payload: bytes) -> None:
        if payload.startswith(b'{"op":"call_service"'):
            self._call = json.loads(payload)["id"]
        elif b'"level":"error"' in payload:
            self.errors += 1
        elif payload.startswith(b'{"op":"service_response"') and b'"result":true' in payload:
            # the one call that players have, by which they measure their link
            self.successes += not (self.role is PLAYER and b'"service":"/rosapi/get_time"' in payload)

    def _connect(self) -> BareClient:
        self.connections += 1
        client = BareClient(self._port, COOKIES.get(self.role.name))
        if self.role is OPERATOR:
            client.say("auth", client="operator", mac="the operators' token")
            for kind in OFFERED:  # so that ROS calls them
                client.say("advertise_service", service=f"/operator/service/{kind.rpartition('/')[2]}", type=kind)
        return client


class Log:
    """What a program writes from now on."""

    def __init__(self, rosbridge: Rosbridge) -> None:
        self._file = open(f"/proc/{rosbridge.program.process.pid}/fd/2", "rb")  # noqa: SIM115
        self._file.seek(0, os.SEEK_END)
        self._rest = b""  # of a line that is not complete

    def trouble(self) -> str:
        """What has been written since the last time, if that is more than short lines about clients."""
        wrong = [line for line in self._lines() if not LINE.fullmatch(line) or not line.isprintable()]
        return "\n".join(wrong)[:5000]

    def _lines(self) -> list[str]:
        *lines, self._rest = (self._rest + self._file.read()).split(b"\n")
        return [line.decode() for line in lines]

    def close(self) -> None:
        self._file.close()


class Arena:
    """rosbridge between three fuzzers and ROS, with a referee who speaks again and again."""

    def __init__(self, rosbridge: Rosbridge, ros: RosSide, master: RosMaster) -> None:
        self.rosbridge, self.ros, self._master = rosbridge, ros, master
        self._spoken, self._turn = -STATUS_PERIOD, 0
        for topic in (OWN, *OTHERS):
            ros.listen(topic)
        for role in (GUEST, PLAYER):
            ros.listen(f"/{role.name}/String", "std_msgs/String")

    def fuzz(self, count: int, fuzzers: Sequence[Fuzzer]) -> int:
        """Send so many operations; by how many bytes the memory has grown. AssertionError that names the newest
        operations when something goes wrong."""
        memory = 0
        with contextlib.closing(Log(self.rosbridge)) as log, ThreadPoolExecutor(len(fuzzers)) as together:
            while (sent := sum(fuzzer.number for fuzzer in fuzzers)) < count:
                if sent < count * WARM_UP:
                    memory = self.memory()
                self._referee()
                try:
                    for fuzzer in fuzzers:
                        fuzzer.connect()
                    for fuzzer in fuzzers:
                        fuzzer.send()
                    list(together.map(Fuzzer.settle, fuzzers))
                    trouble = log.trouble()
                except (OSError, AssertionError) as error:
                    trouble = f"{error} {log.trouble()}"
                assert not trouble, "\n".join(map(str, (*fuzzers, trouble)))
        print(f"memory {memory / 2**20:.1f}, then {self.memory() / 2**20:.1f} MiB;", *map(Fuzzer.metrics, fuzzers))
        return self.memory() - memory

    def serves(self) -> bool:
        """A guest hears of the battle and a player drives."""
        self._play(2)
        before = len(self.ros.heard(OWN))
        with Client(self.rosbridge.port) as guest, Client(self.rosbridge.port, "of-al") as driver:
            guest.watch()
            guest.hear_status(2)
            driver.drive(0)
            until(lambda: FORWARD in self.ros.heard(OWN)[before:], 10, "a command")
        return True

    def registered(self) -> set[tuple[str, str]]:
        """All that rosbridge has ever had in ROS, by kind and name; from the master's own log."""
        logs = list(Path(self._master.env["ROS_LOG_DIR"]).glob("master.log*"))
        assert logs
        return {found for log in logs for found in REGISTERED.findall(log.read_text(errors="replace"))}

    def memory(self) -> int:
        """Of rosbridge, in bytes."""
        return int(psutil.Process(self.rosbridge.program.process.pid).memory_info().rss)

    def _referee(self) -> None:
        """The referee speaks when it is time; now and then he says that the player may not drive."""
        if time.monotonic() - self._spoken > STATUS_PERIOD:
            self._turn += 1
            self._play(0 if self._turn % 10 == 5 else 2, 0 if self._turn % 10 == 9 else 100)

    def _play(self, game: int, life: int = 100) -> None:
        self._spoken = time.monotonic()
        self.ros.status(game, player("al", "of-al", 0, life), player("bo", "of-bo", 1))


class DebiansMaster(RosMaster):
    """Unlike ours, it notes in a file who registers what."""

    PROGRAM = ("/usr/bin/rosmaster", "--core")


@pytest.fixture(scope="module")
def ros_master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RosMaster]:
    master = DebiansMaster(tmp_path_factory.mktemp("ros"))
    master.start()
    yield master
    master.stop()


@pytest.fixture
def arena(rosbridge: Rosbridge, ros: RosSide, ros_master: RosMaster) -> Arena:
    return Arena(rosbridge, ros, ros_master)


def test_every_operation_of_the_page_is_mutated() -> None:
    named = {row["operation"] for row in table(page("protocol-browser.md"), "rosbridge")}
    assert named == OPERATIONS.keys() | WRAPPERS


@pytest.mark.parametrize(
    ("count", "seed"),
    [(2000, 0), pytest.param(COUNT, SEED, marks=[pytest.mark.slow, pytest.mark.timeout(300 + COUNT / 100)])],
)
def test_no_operation_harms_rosbridge_or_reaches_ros_against_the_rules(arena: Arena, count: int, seed: int) -> None:
    with contextlib.ExitStack() as stack:
        fuzzers = [Fuzzer(arena.rosbridge.port, role, seed) for role in (GUEST, PLAYER, OPERATOR)]
        for fuzzer in fuzzers:
            stack.callback(fuzzer.close)
        assert arena.fuzz(count, fuzzers) < GROWTH
    guest, driver, operator = fuzzers
    assert min(guest.errors, driver.errors, operator.errors) > count / 100, "the mutations are too harmless"
    # one call to five are answered in 2000 operations, none where ROS is busy
    assert operator.successes >= count // 10_000, "the mutations do too much harm"
    assert guest.successes == driver.successes == 0
    assert arena.serves()

    for topic in (*OTHERS, "/guest/String", "/player/String"):
        assert not arena.ros.heard(topic), topic
    commands = arena.ros.heard(OWN)
    assert {command[axis] for command in commands for axis in ("linear_x", "angular_z")} == {-1, 0, 1}
    names = arena.registered()
    assert ("PUB", OWN) in names
    assert not {(kind, name) for kind, name in names if re.search("guest|player", name) or name in OTHERS}
    assert ("PUB", "/game_status") not in names
