"""Pictures from the cameras to those who look, many of them."""

import time
from collections.abc import Callable

from laser_bot_battle.names import ABOVE, OVERHEAD_CAMERA
from tests.integration.camera.conftest import Relay, tell_camera
from tests.integration.rosbridge.ends import RosSide
from tests.support.fake_camera import FakeCamera, with_headers
from tests.support.polling import SLOWNESS, until
from tests.support.ros import RosMaster
from tests.support.viewer import Shot, Viewer

OF_ONE_CLOCK = 1.0 * SLOWNESS  # s between two readings of it that a busy machine may need

Start = Callable[..., tuple[int, FakeCamera]]
Connect = Callable[..., Viewer]


def test_a_picture_tells_whose_it_is_and_when_it_was_taken_and_sent(camera: Start, viewer: Connect) -> None:
    robot, eye = camera()
    eye.clock = -3600.0  # the robot's clock is an hour late
    someone = viewer()
    someone.watch(robot)
    first, second = someone.picture(), someone.picture()
    made = time.time() - (time.monotonic() - second.mark.made)
    assert (second.robot, second.number - first.number) == (robot, second.mark.number - first.mark.number)
    assert len(second.jpeg) == 10_000
    assert abs(second.taken - made) < OF_ONE_CLOCK
    assert second.taken <= second.sent + OF_ONE_CLOCK
    assert someone.states[-1] == (robot, "live", "")


def test_fifty_viewers_share_one_stream_and_all_see_the_newest(camera: Start, viewer: Connect) -> None:
    robot, eye = camera()
    crowd = [viewer() for _ in range(50)]
    for each in crowd:
        each.watch(robot)
    for each in crowd:
        numbers = [each.picture().number for _ in range(3)]
        assert numbers == sorted(set(numbers))
    newest = crowd[0].picture().mark.number
    for each in crowd:
        each.picture(lambda shot: shot.mark.number >= newest)
    assert eye.requests == ["GET /stream?extra_headers=1 HTTP/1.0"]


def test_a_hundred_viewers_of_four_cameras_get_pictures(camera: Start, viewer: Connect) -> None:
    cameras = [camera(rate=10) for _ in range(4)]
    crowd = [(viewer(), cameras[number % 4][0]) for number in range(100)]
    for each, robot in crowd:
        each.watch(robot)
    for each, robot in crowd:
        assert {each.picture().robot for _ in range(3)} == {robot}
    assert [eye.connections for _, eye in cameras] == [1, 1, 1, 1]


def test_who_comes_later_gets_the_newest_picture_at_once(camera: Start, viewer: Connect) -> None:
    robot, eye = camera(rate=0.5)
    early, late = viewer(), viewer()
    early.watch(robot)
    shot = early.picture()
    late.watch(robot)
    assert late.picture().number == shot.number
    assert eye.connections == 1


def test_another_wish_takes_the_place_of_the_last(camera: Start, viewer: Connect) -> None:
    (one, _), (two, _) = camera(), camera()
    fickle, steady = viewer(), viewer()
    fickle.watch(one)
    fickle.picture()
    fickle.watch(two)
    fickle.state("live", two)
    assert {fickle.picture().robot for _ in range(5)} == {two}
    fickle.watch(None)
    steady.watch(two)
    steady.picture()
    assert fickle.sees_nothing_while(steady)


def test_nothing_is_fetched_while_nobody_looks(camera: Start, viewer: Connect) -> None:
    robot, eye = camera()
    for leave in (lambda someone: someone.watch(None), lambda someone: someone.close()):
        someone = viewer()
        someone.watch(robot)
        someone.picture()
        left = time.monotonic()
        leave(someone)
        until(lambda: eye.streams == 0, 3, "the relay has left the camera")
        assert time.monotonic() - left > 0.5  # who loads the page again finds the stream as it was
    assert eye.connections == 2


def test_who_loads_the_page_again_finds_the_stream_as_it_was(camera: Start, viewer: Connect) -> None:
    robot, eye = camera()
    for _ in range(5):
        someone = viewer()
        someone.watch(robot)
        someone.picture()
        someone.close()
    assert eye.connections == 1


def test_a_camera_that_becomes_known_later_is_found(camera: Start, viewer: Connect, ros_master: RosMaster) -> None:
    _, eye = camera()
    someone = viewer()
    someone.watch(100)
    assert someone.state("none") == ""
    tell_camera(ros_master, 100, eye.url)
    someone.state("live")
    assert someone.picture().robot == 100


def test_the_camera_above_the_floor_is_where_the_tracker_says(camera: Start, viewer: Connect, referee: RosSide) -> None:
    someone = viewer()
    someone.watch(ABOVE)
    assert someone.state("none") == ""
    _, eye = camera(rate=5)
    eye.part = lambda _, jpeg: with_headers(jpeg, f"Content-Length: {len(jpeg)}")  # any program's: without a time
    pictures: list[Shot] = []

    def comes(target: str) -> bool:
        """Not every publisher is a latched one, and the first word of others may be lost."""
        referee.publish(OVERHEAD_CAMERA, "std_msgs/String", data=f"{eye.url}{target}")
        pictures.extend(message for message in someone.drain() if isinstance(message, Shot))
        return bool(pictures)

    until(lambda: comes("/video?size=large"), 10, "a picture")
    assert eye.requests[-1] == "GET /video?size=large HTTP/1.0"
    shot = pictures[-1]
    assert shot.robot == ABOVE
    assert abs(shot.taken - (time.time() - (time.monotonic() - shot.mark.made))) < OF_ONE_CLOCK


def test_a_viewer_who_reads_but_has_not_drawn_gets_two_pictures(camera: Start, viewer: Connect) -> None:
    robot, _ = camera()
    frozen, other = viewer(), viewer()
    frozen.draws = False
    frozen.watch(robot)
    other.watch(robot)
    frozen.picture()
    frozen.picture()
    assert frozen.sees_nothing_while(other)
    last = other.picture().number
    frozen.say("seen")  # and the next one is the newest
    assert frozen.picture().number >= last


def test_what_is_no_request_is_answered_and_changes_nothing(camera: Start, viewer: Connect) -> None:
    robot, _ = camera()
    someone = viewer()
    someone.watch(robot)
    someone.picture()
    for fields in ({"op": "watch", "robot": -1}, {"op": "watch", "robot": 128}, {"op": "watch", "robot": "3"},
                   {"op": "watch", "robot": True}, {"op": "subscribe"}, {"op": 1}, {"op": "auth"}):  # fmt: skip
        someone.say(**fields)
        assert someone.error()
    assert someone.picture().robot == robot


def test_figures_are_for_operators_and_true(camera: Start, viewer: Connect, relay: Relay, referee: RosSide) -> None:
    robot, _ = camera(rate=20, size=25_000)
    guest, operator = viewer(), viewer().operate()
    guest.watch(robot)
    guest.picture()
    guest.say("figures")
    assert "only operators" in guest.error()

    def measured() -> bool:
        guest.picture()
        eye = next(eye for eye in operator.metrics()["cameras"] if eye["robot"] == robot)
        return bool(abs(eye["rate"] - 20) < 4)

    until(measured, 10, "20 pictures a second")
    figures = operator.metrics()
    assert (figures["viewers"], figures["most_viewers"], figures["most_mbit"]) == (2, 400, 200)
    assert figures["mbit"] > 0.5
    (eye,) = [eye for eye in figures["cameras"] if eye["robot"] == robot]
    assert (eye["viewers"], eye["kilobytes"], eye["state"]) == (1, 25.0, "live")
    assert eye["age"] < 1
