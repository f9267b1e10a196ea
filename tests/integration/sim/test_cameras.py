"""The virtual robots' eyes: the arena's program as a camera."""

import contextlib
import http.client
import io
import os
import signal
import time
from collections.abc import Callable, Iterator
from itertools import pairwise

import psutil
import pytest
import requests
from PIL import Image

from sim.arena.cameras.pages import MAX_CONNECTIONS, RATE
from tests.integration.sim.arena import HOST, Arena, Hardware
from tests.integration.sim.stream import Stream
from tests.support.polling import LATEST, until
from tests.support.timecode import time_of


@contextlib.contextmanager
def looking(arena: Arena, robot: str = "virtual1", room: int | None = None) -> Iterator[Stream]:
    with contextlib.closing(Stream(arena, robot, room)) as stream:
        yield stream


@pytest.fixture
def robot(arena: Arena) -> Iterator[Hardware]:
    with Hardware(arena, "virtual1") as hardware:
        assert hardware.line() == "light 0"
        yield hardware


AS_THE_RELAY = {"X-Laserbot-Relay": "1"}


def painters(arena: Arena) -> list[psutil.Process]:
    """The processes that paint for this arena."""
    return psutil.Process(arena.program.process.pid).children()


def get(arena: Arena, path: str, **headers: str) -> requests.Response:
    """The answer to the relay; of one that is a stream only the head: it has no end."""
    with requests.get(arena.page + path, headers={**AS_THE_RELAY, **headers}, timeout=LATEST, stream=True) as answer:
        if not answer.headers["Content-Type"].startswith("multipart/"):
            assert answer.content
        return answer


@pytest.mark.usefixtures("robot")
def test_the_relay_understands_the_stream(arena: Arena) -> None:
    with looking(arena) as stream:
        before = time.time()
        stamps = [stream.taken() for _ in range(5)]
        part = stream.part()
    assert part
    assert part.headers["content-type"] == "image/jpeg"
    assert Image.open(io.BytesIO(part.body)).size == (320, 240)
    assert all(later > sooner for sooner, later in pairwise(stamps))
    assert before - 1 < stamps[-1] < time.time()


@pytest.mark.slow
@pytest.mark.usefixtures("robot")
def test_there_are_so_many_pictures_a_second(arena: Arena) -> None:
    with looking(arena) as stream:
        stamps = [stream.taken() for _ in range(2 * RATE + 1)]
    steps = sorted(later - sooner for sooner, later in pairwise(stamps))
    assert steps[len(steps) // 2] == pytest.approx(1 / RATE, rel=0.2)
    assert (stamps[-1] - stamps[0]) / (len(stamps) - 1) > 0.95 / RATE


def test_a_picture_shows_where_the_robot_is_now(arena: Arena, robot: Hardware) -> None:
    before = get(arena, "eyes/virtual1/snapshot")
    assert before.headers["Content-Type"] == "image/jpeg"
    assert before.headers["Cache-Control"] == "no-store"
    assert "Content-Encoding" not in before.headers
    assert float(before.headers["X-Timestamp"]) == pytest.approx(time.time(), abs=5)
    again = get(arena, "eyes/virtual1/snapshot")
    assert again.content == before.content  # nothing has moved
    robot.turn_wheels(-0.05, 0.05)
    until(lambda: get(arena, "eyes/virtual1/snapshot").content != before.content, what="another picture")


def test_one_sees_another_robot_shoot(arena: Arena, robot: Hardware) -> None:
    with Hardware(arena, "virtual2") as other:
        assert other.line() == "light 0"
        other.drive_to(1.2, 1.03)
        calm = get(arena, "eyes/virtual2/snapshot").content
        other.send("beam 1")
        until(lambda: get(arena, "eyes/virtual2/snapshot").content != calm, what="a shot")
        other.send("beam 0")
        until(lambda: get(arena, "eyes/virtual2/snapshot").content == calm, what="no shot any more")


@pytest.mark.usefixtures("robot")
def test_nothing_is_painted_while_nobody_looks(arena: Arena) -> None:
    assert painters(arena) == []
    with looking(arena) as stream:
        stream.taken()
        (painter,) = painters(arena)
    idle: list[float] = []

    def rests() -> bool:
        """The process has got no processor time between two looks at it, or is gone."""
        with contextlib.suppress(psutil.NoSuchProcess):
            used = painter.cpu_times()
            idle.append(used.user + used.system)
            time.sleep(0.2)  # four pictures
            return len(idle) > 1 and idle[-1] == idle[-2]
        return True

    until(rests, 3, "it paints no more")
    until(lambda: painters(arena) == [], 20, "it is ended")
    with looking(arena) as stream:
        assert stream.taken()


@pytest.mark.parametrize("path", ["stream", "snapshot"])
@pytest.mark.parametrize(
    "headers",
    [{}, {"Sec-Fetch-Site": "none"}, {"Origin": "null", **AS_THE_RELAY}],
    ids=["an image", "a person", "a script"],
)
@pytest.mark.usefixtures("robot")
def test_a_page_gets_no_pictures(arena: Arena, path: str, headers: dict[str, str]) -> None:
    """Nor whoever types the address: the relay knows who may see what."""
    answer = requests.get(f"{arena.page}eyes/virtual1/{path}", headers=headers, timeout=LATEST)
    assert answer.status_code == 403
    assert "relay" in answer.text
    assert painters(arena) == []


@pytest.mark.parametrize("path", ["stream", "snapshot"])
@pytest.mark.usefixtures("robot")
def test_who_asks_for_an_unknown_robot_hears_which_there_are(arena: Arena, path: str) -> None:
    with Hardware(arena, "guest") as guest:
        guest.line()
        answer = get(arena, f"eyes/virtual7/{path}")
    assert answer.status_code == 404
    assert answer.headers["Content-Type"].startswith("text/plain")
    assert answer.text == "no robot virtual7 is on the floor; there are: guest, virtual1"


@pytest.mark.usefixtures("robot")
def test_one_can_ask_for_fewer_pictures_and_is_told_how_many_there_could_be(arena: Arena) -> None:
    with looking(arena) as stream:
        part = stream.part()
    assert part
    assert part.headers["x-laserbot-rate"] == str(RATE)
    assert get(arena, "eyes/virtual1/stream?rate=5").status_code == 200
    for rate in ("0", str(RATE + 1), "-5", "2.5", "many", ""):
        answer = get(arena, f"eyes/virtual1/stream?rate={rate}")
        assert answer.status_code == 400
        assert answer.text == f"rate must be a whole number of pictures a second, from 1 to {RATE}"


@pytest.mark.usefixtures("robot")
def test_there_are_not_more_pictures_than_were_asked_for(arena: Arena) -> None:
    with contextlib.closing(Stream(arena, "virtual1", rate=5)) as stream:
        parts = [stream.part() for _ in range(6)]
    painted = [float(part.headers["x-timestamp"]) for part in parts if part]  # s, however late they were read
    assert painted[5] - painted[0] > 0.8  # at the full rate it would be a quarter of a second


@pytest.mark.parametrize("path", ["stream", "snapshot"])
@pytest.mark.usefixtures("robot")
def test_only_the_head_costs_no_picture_and_nothing_can_be_sent(arena: Arena, path: str) -> None:
    address = f"{arena.page}eyes/virtual1/{path}"
    head = requests.head(address, headers=AS_THE_RELAY, timeout=LATEST)
    assert head.status_code == 200
    assert head.headers["Content-Type"].startswith("multipart/x-mixed-replace" if path == "stream" else "image/jpeg")
    assert requests.post(address, data="picture", timeout=LATEST).status_code == 405
    assert painters(arena) == []


def test_a_robot_that_leaves_ends_its_streams_and_no_others(arena: Arena, robot: Hardware) -> None:
    with Hardware(arena, "virtual2") as other, looking(arena) as stream, looking(arena, "virtual2") as others:
        assert other.line()
        stream.taken()
        robot.close()
        until(lambda: stream.part() is None, what="the end of the stream")
        left = time.time()
        until(lambda: others.taken() > left + 0.2, what="the others' pictures")
    assert get(arena, "eyes/virtual1/snapshot").status_code == 404


@pytest.mark.slow
@pytest.mark.usefixtures("robot")
def test_one_more_than_the_most_is_turned_away_and_room_is_made_by_leaving(arena: Arena) -> None:
    with contextlib.ExitStack() as stack:
        first = stack.enter_context(looking(arena))
        for _ in range(MAX_CONNECTIONS - 1):
            stack.enter_context(looking(arena))
        assert get(arena, "eyes/virtual1/stream").status_code == 503
        assert get(arena, "eyes/virtual1/snapshot").status_code == 503
        first.close()
        until(lambda: get(arena, "eyes/virtual1/snapshot").status_code == 200, what="room")


@pytest.mark.slow
@pytest.mark.usefixtures("robot")
def test_a_slow_reader_skips_pictures_and_delays_nobody(arena: Arena) -> None:
    with looking(arena, room=4096) as slow, looking(arena) as quick:
        slow.taken()
        began = quick.taken()
        while (paused := quick.taken()) < began + 2.5:  # 50 pictures
            pass
        old = 0
        while slow.taken() < paused:
            old += 1
        assert old < 12
        assert quick.taken() > paused


@pytest.mark.slow
@pytest.mark.usefixtures("robot")
def test_a_reader_that_has_stopped_is_disconnected(arena: Arena) -> None:
    with looking(arena, room=4096), looking(arena) as other:
        until(lambda: other.taken() and "has stopped reading" in arena.program.output, 20, "a line in the log")


@pytest.mark.usefixtures("robot")
def test_a_killed_painter_comes_back_and_the_stream_goes_on(arena: Arena) -> None:
    with looking(arena) as stream:
        stream.taken()
        (painter,) = painters(arena)
        painter.kill()
        killed = time.time()
        until(lambda: stream.taken() > killed + 0.5, 20, "newer pictures")
        (successor,) = painters(arena)
    assert successor.pid != painter.pid
    assert "started again: it has ended" in arena.program.output


@pytest.mark.slow
@pytest.mark.usefixtures("robot")
def test_a_stuck_painter_is_replaced(arena: Arena) -> None:
    with looking(arena) as stream:
        stream.taken()
        (painter,) = painters(arena)
        painter.suspend()
        stopped = time.time()
        until(lambda: stream.taken() > stopped + 1, 20, "newer pictures")
        assert painter.pid not in [successor.pid for successor in painters(arena)]


@pytest.mark.parametrize("signum", [signal.SIGTERM, signal.SIGKILL])
@pytest.mark.usefixtures("robot")
def test_the_painter_ends_with_the_arena(new_arena: Callable[..., Arena], signum: signal.Signals) -> None:
    arena = new_arena()
    with Hardware(arena, "virtual1") as robot:
        robot.line()
        with looking(arena) as stream:
            stream.taken()
            (painter,) = painters(arena)
            os.kill(arena.program.process.pid, signum)  # and not its group
            arena.program.exit_code()
            with contextlib.suppress(psutil.NoSuchProcess):
                painter.wait(10)
    assert not painter.is_running()
    assert "Traceback" not in arena.program.output


@pytest.mark.slow
def test_with_a_time_code_a_picture_tells_when_it_was_taken(new_arena: Callable[..., Arena]) -> None:
    arena = new_arena("--timecode")
    with Hardware(arena, "virtual1") as robot:
        robot.line()
        answer = get(arena, "eyes/virtual1/snapshot")
    assert time_of(answer.content) == round(float(answer.headers["X-Timestamp"]) * 1000) % 2**24


def test_the_arenas_other_pages_are_as_before(arena: Arena) -> None:
    connection = http.client.HTTPConnection(HOST, arena.view_port, timeout=LATEST)
    connection.request("GET", "/", headers={"Sec-Fetch-Site": "cross-site"})
    answer = connection.getresponse()
    assert (answer.status, answer.headers["Content-Type"]) == (200, "text/html")
    answer.read()
    connection.close()
