"""Cameras that are away, sick, or none: viewers are told why, others do not notice, and recovered ones are found."""

import time
from collections.abc import Callable
from typing import Any

import pytest

from tests.integration.camera.conftest import tell_camera
from tests.support.fake_camera import BOUNDARY, HEAD, FakeCamera, part_of, with_headers
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.ros import RosMaster
from tests.support.viewer import Viewer

Start = Callable[..., tuple[int, FakeCamera]]
Connect = Callable[..., Viewer]

FIRST = b"--" + BOUNDARY + b"\r\n"
STAMP = "X-Timestamp: 1700000000.0"
MIB = 2**20


def part(*headers: str, body: bytes = b"\xff\xd8\xff\xd9") -> Callable[[FakeCamera, bytes], bytes]:
    """Instead of each picture."""
    return lambda camera, jpeg: with_headers(body, *headers)


@pytest.mark.parametrize(
    ("head", "reason"),
    [
        (b"SSH-2.0-OpenSSH_9.2\r\n\r\n", "what answers there is no camera"),
        (b"\0" * 10_000, "what answers there is no camera"),
        (b"HTTP/1.0 200 OK\r\nX: " + b"x" * 100_000, "what answers there is no camera"),
        (b"HTTP/1.0 503 Refused\r\n\r\n", "the camera answers 503 Refused"),
        (
            b"HTTP/1.0 200 OK\r\nContent-Type: text/html\r\n\r\n",
            "the camera sends something else than a stream of pictures",
        ),
        (HEAD.removesuffix(FIRST) + b"rubbish", "the camera sends garbage between its pictures"),
    ],
    ids=["another program", "zeros", "an endless head", "its door", "a page", "garbage"],
)
def test_an_answer_that_is_no_stream_is_named(camera: Start, viewer: Connect, head: bytes, reason: str) -> None:
    robot, eye = camera()
    eye.head = head
    someone = viewer()
    someone.watch(robot)
    assert someone.waits(reason)
    assert someone.shots == 0


@pytest.mark.parametrize(
    ("sick", "reason"),
    [
        (part(STAMP), "the camera does not tell how long a picture is"),
        (part(STAMP, "Content-Length: -1"), "the camera does not tell how long a picture is"),
        (part(STAMP, "Content-Length: 2"), "the camera sends garbage between its pictures"),
        (part(STAMP, f"Content-Length: {MIB + 1}"), "the camera sends a picture of 1048577 bytes; 1048576 are allowed"),
        (part(STAMP, "Content-Length: 5", body=b"<html"), "the camera sends something else than pictures"),
        (part("Content-Length: 5", body=b"\xff\xd8\xff\xff\xd9"), "the camera does not tell when a picture was taken"),
        (part("X: " + "x" * 5000), "the camera sends a picture with too long a head"),
        (part("no header"), "the camera sends garbage"),
        (
            lambda camera, jpeg: part_of(camera, jpeg).replace(BOUNDARY, b"another"),
            "the camera sends garbage between its pictures",
        ),
    ],
    ids=[
        "no length", "a negative length", "too short a length", "more than 1 MiB", "no JPEG", "no time", "a long head",
        "no header", "another boundary",
    ],
)  # fmt: skip
def test_a_picture_that_is_none_ends_the_connection_and_the_camera_is_tried_again(
    camera: Start, viewer: Connect, sick: Callable[[FakeCamera, bytes], bytes], reason: str
) -> None:
    robot, eye = camera()
    someone = viewer()
    someone.watch(robot)
    someone.picture()
    eye.part = sick
    assert someone.waits(reason)
    until(lambda: eye.streams == 0)
    assert someone.drain() == []


@pytest.mark.slow
def test_sick_cameras_are_tried_once_a_second_and_harm_no_other(camera: Start, viewer: Connect) -> None:
    (good, _), (bad, eye) = camera(rate=20), camera()
    eye.head = b"\0" * 10_000
    someone, patient = viewer(), viewer()
    someone.watch(good)
    patient.watch(bad)
    someone.picture()
    began = time.monotonic()
    until(lambda: eye.connections == 3)
    assert time.monotonic() - began > 1.8
    eye.head = HEAD
    patient.state("live")
    assert patient.picture().robot == bad
    assert eye.streams == 1


def drip(camera: FakeCamera, jpeg: bytes) -> bytes:
    """A picture that comes byte by byte, and never to its end."""
    camera.part = lambda camera, jpeg: b"x"
    return with_headers(jpeg, STAMP, f"Content-Length: {MIB}")


@pytest.mark.slow
def test_a_camera_that_stands_still_is_given_up_while_its_picture_grows_old(camera: Start, viewer: Connect) -> None:
    stopped, mute, dripping = camera(), camera(), camera(rate=10)
    mute[1].head = b""
    mute[1].is_frozen = True
    viewers: dict[str, Viewer] = {}
    for name, (robot, _) in {"stopped": stopped, "mute": mute, "dripping": dripping}.items():
        viewers[name] = viewer()
        viewers[name].watch(robot)
    viewers["stopped"].picture()
    viewers["dripping"].picture()
    stopped[1].is_frozen = True
    dripping[1].part = drip
    operator, ages = viewer().operate(), []

    def has_aged() -> bool:
        figures = {eye["robot"]: eye for eye in operator.metrics()["cameras"]}
        ages.append(figures[stopped[0]]["age"])
        return bool(ages[-1] is not None and ages[-1] > 1)

    until(has_aged, 5, "an old picture")
    for each in viewers.values():
        assert each.waits("no picture came for 3 s")
    stopped[1].is_frozen = False
    viewers["stopped"].state("live")
    viewers["stopped"].picture()


def test_a_camera_that_is_pulled_out_is_away_until_it_is_back(camera: Start, viewer: Connect) -> None:
    robot, eye = camera()
    someone = viewer()
    someone.watch(robot)
    someone.state("live")
    eye.is_online = False
    assert someone.state("waiting") == "the camera is away"
    assert someone.picture().robot == robot  # it says so, too
    eye.is_online = True
    someone.state("live")
    assert eye.connections == 1


def test_a_camera_whose_program_is_started_again_is_found(camera: Start, viewer: Connect) -> None:
    robot, eye = camera()
    someone = viewer()
    someone.watch(robot)
    first = someone.picture()
    eye.stop()
    assert someone.waits("the camera cannot be reached")
    late = viewer()
    late.watch(robot)
    assert late.state("waiting")
    assert late.drain() == []  # what was last seen is no news
    eye.start()
    someone.state("live")
    assert someone.picture().number > first.number


def test_a_connection_that_is_cut_is_opened_again(camera: Start, viewer: Connect) -> None:
    robot, eye = camera()
    someone = viewer()
    someone.watch(robot)
    someone.picture()
    eye.cut()
    assert someone.state("waiting") in {"the camera has ended the stream", "the connection to the camera is lost"}
    someone.state("live")
    someone.picture()


@pytest.mark.parametrize(
    "address", ["http://127.0.0.1", "file:///etc/passwd", "http://a b:80", "http://x:99999", 3, [""]]
)
def test_a_wrong_address_is_told(viewer: Connect, ros_master: RosMaster, robots: Any, address: object) -> None:
    robot = next(robots)
    tell_camera(ros_master, robot, address)  # type: ignore[arg-type]
    someone = viewer()
    someone.watch(robot)
    assert someone.waits("the robot tells a wrong address of its camera")


@pytest.mark.parametrize("name", ["a..b", "x" * 70, "[::::]"])
def test_an_address_whose_name_can_be_none_is_told(
    viewer: Connect, ros_master: RosMaster, robots: Any, name: str
) -> None:
    robot = next(robots)
    tell_camera(ros_master, robot, f"http://{name}:8090")
    someone = viewer()
    someone.watch(robot)
    assert someone.waits("the camera cannot be reached")


def test_an_address_where_nobody_is_and_one_that_is_corrected(
    camera: Start, viewer: Connect, ros_master: RosMaster, robots: Any
) -> None:
    (_, eye), robot = camera(), next(robots)
    tell_camera(ros_master, robot, f"http://127.0.0.1:{free_port()}")
    someone = viewer()
    someone.watch(robot)
    assert someone.waits("the camera cannot be reached")
    tell_camera(ros_master, robot, f"{eye.url}/eyes/virtual0/")
    someone.picture()
    assert eye.requests == ["GET /eyes/virtual0/stream?extra_headers=1 HTTP/1.0"]
