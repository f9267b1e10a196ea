"""A camera that can send fewer pictures is asked for as many as those who look can show."""

import contextlib
import threading
from collections.abc import Callable, Iterator

from laser_bot_battle.names import RATE_HEADER
from tests.support.fake_camera import FakeCamera, part_of
from tests.support.polling import until
from tests.support.viewer import Viewer

RATE = 20
DRAWING = 0.5  # s that a slow viewer needs for a picture
PAUSE = 0.01  # s between two looks at what has come


@contextlib.contextmanager
def again_and_again(act: Callable[[], object], seconds: float) -> Iterator[None]:
    """In a thread, with so many s in between."""
    over = threading.Event()

    def work() -> None:
        while not over.wait(seconds):
            act()

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def can_send_fewer(eye: FakeCamera, jpeg: bytes) -> bytes:
    return f"{RATE_HEADER}: {RATE}\r\n".encode() + part_of(eye, jpeg)


def test_a_camera_is_asked_for_as_many_pictures_as_the_fastest_viewer_draws(
    camera: Callable[..., tuple[int, FakeCamera]], viewer: Callable[..., Viewer]
) -> None:
    robot, eye = camera(rate=RATE)
    eye.part = can_send_fewer

    def fewer_since(request: int) -> bool:
        return any("rate=" in line for line in eye.requests[request:])

    with contextlib.ExitStack() as viewers:

        def slow_one() -> Viewer:
            one = viewer()  # not sooner: it answers no ping until it is read from
            one.draws = False
            one.watch(robot)
            viewers.enter_context(again_and_again(lambda: one.say("seen"), DRAWING))
            # the reader ends first: after a ping it blocks until the next picture
            viewers.enter_context(again_and_again(one.drain, PAUSE))
            return one

        first = slow_one()
        until(lambda: fewer_since(0), what="fewer pictures are asked for")
        assert "rate=" not in eye.requests[0]
        before = len(eye.requests)
        second = slow_one()
        until(lambda: fewer_since(before), what="fewer pictures are asked for again")
        assert "rate=" not in eye.requests[before]  # nothing was known of the second
        second.draws = True  # at once
        until(lambda: "rate=" not in eye.requests[-1], what="all pictures are asked for")
    told = [state for _, state, _ in first.states]
    assert (told.count("live"), told[-1]) == (1, "live"), "nobody hears of the change"
