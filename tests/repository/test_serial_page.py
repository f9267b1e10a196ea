"""docs/protocol-serial.md against the firmware in the simulator (the Pi's side: test_serial_page_pi.py)."""

import contextlib
from collections.abc import Iterator

import pytest

from tests.support.avr import Arena, AvrRobot, SerialHost, avr_robot
from tests.support.documents import Row, page, table
from tests.support.polling import until

PAGE = page("protocol-serial.md")
CONVERSATION = table(PAGE, "Conversation")
QUIET = 3.0  # s; a talking Arduino asks for the time more often


@pytest.fixture(scope="module")
def arena() -> Iterator[Arena]:
    with contextlib.closing(Arena()) as arena:
        yield arena


@pytest.fixture(scope="module")
def robot(arena: Arena, tmp_path_factory: pytest.TempPathFactory) -> Iterator[AvrRobot]:
    with avr_robot("--serial", tmp_path_factory.mktemp("robot") / "tty", arena=arena.address) as robot:
        yield robot


@pytest.fixture(scope="module")
def host(robot: AvrRobot) -> Iterator[SerialHost]:
    with contextlib.closing(SerialHost(robot.uart)) as host:
        yield host


def said_by(who: str) -> list[bytes]:
    return [bytes.fromhex(row["bytes"]) for row in CONVERSATION if row["from"] == who]


def test_the_arduino_says_what_the_page_says(robot: AvrRobot, host: SerialHost, arena: Arena) -> None:
    ask, *_, stop = said_by("Pi")
    *answer, hit = said_by("Arduino")

    def received() -> bytes:
        assert host.frames is not None  # reads what has come
        return host.received

    host.send(ask)
    until(lambda: len(received()) >= len(b"".join(answer)), 5, "the answer")
    assert received() == b"".join(answer)

    arena.accept().send("light 1\n")
    until(lambda: hit in received()[len(b"".join(answer)) :], 5, "the hit")

    mark = robot.mark()
    host.send(stop)
    until(lambda: len(robot.cycles_of("uart-in", since=mark)) > 0, 5, "the robot gets the stop")
    robot.let_pass(0.1)
    silent_from = len(received())
    robot.let_pass(QUIET)
    assert len(received()) == silent_from


@pytest.mark.parametrize("row", table(PAGE, "Commands"), ids=lambda row: row["what"])
def test_a_command_of_the_page_moves_the_wheels_as_it_says(robot: AvrRobot, host: SerialHost, row: Row) -> None:
    before = {side: robot.position(side) for side in ("left", "right")}
    mark = robot.mark()
    host.send(bytes.fromhex(row["bytes"]))
    until(lambda: robot.cycles_of("uart-in", since=mark), 5, "the robot gets the command")
    robot.let_pass(0.4)
    for side, start in before.items():
        assert robot.position(side) - start == pytest.approx(int(row[f"{side} wheel"]), abs=2)
    assert bool(robot.cycles_of("beam", "1", since=mark)) == (row["shoot"] == "true")
    if row["shoot"] == "true":
        until(lambda: robot.cycles_of("beam", "0", since=mark), 5, "the end of the shot")
        robot.let_pass(0.1)
