"""The real firmware in the AVR simulator: what the Uno does with its motors, laser, sensor and serial port.

Times are measured in AVR cycles from the simulator's trace, so that a busy computer does not matter.
"""

import contextlib
import itertools
import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from laser_bot_battle.msg import BoardHealth, Hit, Robot_msg, Setup
from tests.support.avr import (
    CYCLES_PER_SECOND,
    HIT,
    RESPONSE_ID,
    TIME_ID,
    Arena,
    AvrRobot,
    Frame,
    SerialHost,
    avr_robot,
    command,
    frame,
)
from tests.support.firmware_bench import Bench, bench_in
from tests.support.polling import until
from tests.support.virtual_time import uno

FULL = 1024.0  # half-steps/s
SCALED = 716.8
STOP_WITHIN = 0.350 * CYCLES_PER_SECOND


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    with bench_in(tmp_path) as bench:
        yield bench


@pytest.fixture(scope="module")
def shared_bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    """For the tests that leave the robot still, as they found it."""
    with bench_in(tmp_path_factory.mktemp("robot")) as bench:
        yield bench


def speed(steps: list[tuple[int, int]]) -> float:
    """Mean half-steps/s, negative backwards."""
    (first, start), (last, end) = steps[0], steps[-1]
    return (end - start) * CYCLES_PER_SECOND / (last - first)


def at_speed(steps: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The steps from 100 ms after the first on: it has got up its speed."""
    return [step for step in steps if step[0] >= steps[0][0] + CYCLES_PER_SECOND // 10]


def one_percent(value: float) -> object:
    return pytest.approx(value, rel=0.01)


def string(text: str) -> bytes:
    return len(text).to_bytes(4, "little") + text.encode()


EMPTY = "std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e"


def test_negotiation_names_the_topics_with_their_types_and_checksums(bench: Bench) -> None:
    infos = [frame for frame in bench.host.frames if frame.topic_id in (0, 1)]

    def info(kind: int, topic_id: int, name: str, type_name: str, md5: str) -> Frame:
        texts = string(name) + string(type_name) + string(md5)
        return Frame(kind, bytes([topic_id, 0]) + texts + b"\x18\x01\x00\x00")

    def own(message: type) -> tuple[str, str]:
        return message._type, message._md5sum  # type: ignore[attr-defined]

    assert infos == [
        info(0, 125, "response", *EMPTY),
        info(1, 100, "command", *own(Robot_msg)),
        info(0, 126, "hit", *own(Hit)),
        info(0, 127, "board", *own(BoardHealth)),
        info(1, 101, "setup", *own(Setup)),
        info(1, 102, "identify", *EMPTY),
    ]


@pytest.mark.parametrize(
    ("linear_x", "angular_z", "left", "right"),
    [
        (1, 0, -FULL, FULL),
        (1, 1, -FULL, SCALED),
        (1, -1, -SCALED, FULL),
        (-1, 0, FULL, -FULL),
        (-1, 1, FULL, -SCALED),
        (-1, -1, SCALED, -FULL),
        (0, 1, -FULL, -FULL),
        (0, -1, FULL, FULL),
    ],
)
def test_a_command_turns_the_wheels_for_one_movement_and_no_longer(
    shared_bench: Bench, linear_x: int, angular_z: int, left: float, right: float
) -> None:
    robot = shared_bench.robot

    mark = robot.mark()
    shared_bench.host.send(command(linear_x, angular_z))
    until(lambda: robot.steps("left", mark) and robot.steps("right", mark), 5, "both wheels move")
    robot.wait_until_still()

    for wheel, expected in (("left", left), ("right", right)):
        steps = robot.steps(wheel, mark)
        assert speed(at_speed(steps)) == one_percent(expected)
        assert len(steps) == pytest.approx(320 if abs(expected) == FULL else 230, abs=2)
    assert robot.last_step() - shared_bench.last_command() <= STOP_WITHIN


@pytest.mark.parametrize(("linear_x", "angular_z"), [(0, 0), (0, 2), (0, -128), (2, 0), (-2, 1), (127, -1)])
def test_neutral_and_unknown_movements_stop_the_wheels_at_once(
    shared_bench: Bench, linear_x: int, angular_z: int
) -> None:
    robot, host = shared_bench.robot, shared_bench.host
    mark = robot.mark()

    host.send(command(1, 1))
    until(lambda: len(robot.steps("right", mark)) > 20, 5, "wheels turn")
    host.send(command(linear_x, angular_z))
    until(lambda: len(robot.cycles_of("uart-in", since=mark)) == 2, 5, "the robot gets the second command")
    robot.wait_until_still()

    assert robot.last_step() - shared_bench.last_command() <= 0.005 * CYCLES_PER_SECOND


@pytest.mark.parametrize(("linear_x", "angular_z"), [(1, 0), (1, 1), (-1, -1), (0, 1)])
def test_both_wheels_stand_still_soon_after_the_last_command(
    shared_bench: Bench, linear_x: int, angular_z: int
) -> None:
    silences: list[int] = []

    def driven() -> bool:
        mark = shared_bench.robot.mark()
        shared_bench.stream(command(linear_x, angular_z), 0.3)
        shared_bench.robot.wait_until_still()
        silences.append(shared_bench.robot.last_step() - shared_bench.last_command())
        return shared_bench.was_driven(mark)

    until(driven, 30, "a stream without a gap")
    assert 0.3 * CYCLES_PER_SECOND <= silences[-1] <= STOP_WITHIN


@pytest.mark.parametrize(("angular_z", "left", "right"), [(0, -FULL, FULL), (-1, -SCALED, FULL)])
def test_speed_is_exact_under_a_stream_of_commands_and_light(
    bench: Bench, angular_z: int, left: float, right: float
) -> None:
    def drive() -> tuple[int, int, int]:
        """The mark before, the hits of the drive, and its end."""
        mark, hits = bench.robot.mark(), bench.hits()
        for _ in range(11):
            bench.stream(command(1, angular_z), 0.1)
            bench.arena.send("light 1\n")
            bench.stream(command(1, angular_z), 0.1)
            bench.arena.send("light 0\n")
        end = bench.last_command()
        bench.robot.wait_until_still()
        return mark, bench.hits() - hits, end

    drives: list[tuple[int, int, int]] = []

    def driven() -> bool:
        drives.append(drive())
        return bench.was_driven(drives[-1][0])

    until(driven, 30, "a stream without a gap")
    mark, hits, end = drives[-1]
    for wheel, expected in (("left", left), ("right", right)):
        steps = at_speed([step for step in bench.robot.steps(wheel, mark) if step[0] <= end])
        assert steps[-1][0] - steps[0][0] >= 2 * CYCLES_PER_SECOND
        assert speed(steps) == one_percent(expected)
    assert bench.robot.cycles_of("slip") == []
    assert hits == 11


def test_a_shot_is_one_pulse_of_half_a_second_and_further_shots_meanwhile_are_ignored(bench: Bench) -> None:
    robot = bench.robot

    bench.host.stream(command(0, 0, shoot=True), 0.2)
    until(lambda: robot.cycles_of("beam", "0"), 5, "end of the pulse")
    robot.let_pass(0.6)
    assert len(robot.cycles_of("beam", "1")) == 1
    bench.host.send(command(0, 0, shoot=True))
    until(lambda: len(robot.cycles_of("beam", "0")) == 2, 5, "end of the second pulse")

    for on, off in zip(robot.cycles_of("beam", "1"), robot.cycles_of("beam", "0"), strict=True):
        assert (off - on) / CYCLES_PER_SECOND == one_percent(0.5)


def test_light_on_the_sensor_is_reported_as_one_hit(bench: Bench) -> None:
    before = len(bench.host.received)
    bench.light_pulse(0.5)
    until(lambda: bench.robot.cycles_of("light", "0"), 5, "end of the light")
    bench.robot.let_pass(0.15)

    assert bench.hits() == 1
    assert HIT in bench.host.received[before:]


@pytest.mark.slow
def test_flickering_light_is_no_hit(bench: Bench) -> None:
    flashes = 1200
    bench.arena.send("light 1\nlight 0\n" * flashes)  # 300 ms
    until(lambda: len(bench.robot.cycles_of("light", "0")) == flashes, 5, "the end of the light")
    bench.robot.let_pass(0.15)

    assert bench.hits() == 0


def test_pulses_more_than_100_ms_apart_are_a_hit_each(bench: Bench) -> None:
    for number in (1, 2, 3):
        bench.light_pulse(0.05)
        until(lambda number=number: bench.hits() == number, 5, f"hit {number}")
        bench.robot.let_pass(0.12)

    edges = bench.robot.cycles_of("light", "1")
    assert all(later - earlier > 0.1 * CYCLES_PER_SECOND for earlier, later in itertools.pairwise(edges))
    assert bench.hits() == 3


def test_light_before_the_negotiation_is_not_reported(tmp_path: Path) -> None:
    arena = Arena()
    with (
        contextlib.closing(arena),
        avr_robot("--serial", tmp_path / "tty", arena=arena.address) as robot,
        contextlib.closing(SerialHost(robot.uart)) as host,
    ):
        link = arena.accept()
        link.send("light 1\n")
        robot.let_pass(0.05)
        link.send("light 0\n")
        until(lambda: robot.cycles_of("light", "0"), 5, "the light")
        robot.let_pass(0.05)
        host.negotiate()
        robot.let_pass(0.15)
        assert host.count(RESPONSE_ID) == 0


def test_a_flood_of_light_edges_neither_slows_the_wheels_nor_corrupts_frames() -> None:
    with uno(coded=False) as robot:
        robot.connect()
        for quarter in range(4000):  # 4000 edges/s for 1 s
            if quarter % 100 == 0:
                robot.send(command(1, 0))
            robot.shine(quarter % 2 == 0)
            robot.run(0.00025)
        end = robot.now
        for wheel, expected in ((1, -FULL), (2, FULL)):
            steps = [(step[0], step[wheel]) for step in robot.steps if step[0] <= end]
            assert speed(at_speed(steps)) == one_percent(expected)
        assert robot.said(RESPONSE_ID) == []
        robot.run(0.2)
        robot.shine(True)
        robot.run(0.05)
        robot.shine(False)
        robot.run(0.05)
        assert len(robot.said(RESPONSE_ID)) == 1, "a hit after the flood"


HALF = command(1, 0)[:7]
NO_COMMAND = [
    pytest.param(HALF, id="half a frame"),
    pytest.param(b"\xff\xfe\xff\xff", id="an absurd length"),
    pytest.param(command(1, 0)[:-1] + b"\x00", id="wrong checksum"),
    pytest.param(frame(100, b"\x01\x00"), id="command without its shot"),
    pytest.param(frame(100, b"\x01\x00\x01\x01"), id="command too long"),
    pytest.param(frame(101, b"\x01\x00\x01"), id="unknown topic"),
    pytest.param(b"\xff" * 40, id="idle line noise"),
    pytest.param(random.Random(2).randbytes(2000), id="random bytes"),
]


@pytest.mark.parametrize("garbage", NO_COMMAND)
def test_garbage_on_the_line_does_nothing_and_the_next_good_command_works(shared_bench: Bench, garbage: bytes) -> None:
    robot, host = shared_bench.robot, shared_bench.host
    mark = robot.mark()

    host.send(garbage)
    robot.let_pass(0.03 + len(garbage) / 5760)
    assert robot.cycles_of("coil", since=mark) == robot.cycles_of("beam", since=mark) == []
    host.send(command(0, 1))
    until(lambda: robot.cycles_of("coil", since=mark), 1, "movement")
    robot.wait_until_still()
    assert robot.cycles_of("uart-drop") == []


def test_a_good_command_right_behind_half_a_frame_works(shared_bench: Bench) -> None:
    mark = shared_bench.robot.mark()
    shared_bench.host.send(HALF + command(0, 1))
    until(lambda: shared_bench.robot.cycles_of("coil", since=mark), 1, "movement")
    shared_bench.robot.wait_until_still()


@pytest.mark.slow
def test_the_robot_asks_for_the_time_every_2500_ms_answered_or_not(tmp_path: Path) -> None:
    (tmp_path / "answered").mkdir()
    (tmp_path / "alone").mkdir()
    with bench_in(tmp_path / "answered") as answered, bench_in(tmp_path / "alone") as alone:

        def three_requests() -> bool:
            while answered.host.count(TIME_ID) > len(answers):
                answers.append(frame(TIME_ID, bytes(8)))
                answered.host.send(answers[-1])
            return answered.host.count(TIME_ID) >= 3 and alone.host.count(TIME_ID) >= 3

        answers: list[bytes] = []
        until(three_requests, 10, "three time requests each")
        for bench in (answered, alone):
            bench.robot.let_pass(0.05)  # what comes beside the last one
            intervals = [(b - a) / CYCLES_PER_SECOND for a, b in itertools.pairwise(questions(bench.robot))]
            assert intervals and intervals == [one_percent(2.5)] * len(intervals)


def questions(robot: AvrRobot) -> list[int]:
    """When (cycle) it has asked for the time since the negotiation: 16 bytes, perhaps beside the 39 on `board`."""
    bursts: list[tuple[int, int]] = []
    last = -CYCLES_PER_SECOND
    for event in robot.events:
        if event.words[0] != "uart-out":
            continue
        if event.cycles - last > CYCLES_PER_SECOND // 100:
            bursts.append((event.cycles, 0))
        start, length = bursts[-1]
        bursts[-1] = (start, length + int(event.words[1]))
        last = event.cycles
    return [start for start, length in bursts if length in (16, 16 + 39)]
