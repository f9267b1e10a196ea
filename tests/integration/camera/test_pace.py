"""A virtual robot's eyes are painted at the rate that those who look can show."""

import contextlib
import threading
from collections.abc import Callable, Iterator

from tests.integration.camera.conftest import tell_camera
from tests.integration.sim.arena import Arena, Hardware
from tests.support.polling import until
from tests.support.ros import RosMaster
from tests.support.viewer import Viewer

DRAWING = 0.2  # s that a slow viewer needs for a picture
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


def painted(viewer: Viewer) -> float:
    """Pictures a second that come from the arena, however few of them this viewer gets."""
    first, *_, last = (viewer.picture() for _ in range(5))
    return (last.number - first.number) / (last.taken - first.taken)


def test_eyes_are_painted_as_often_as_the_fastest_viewer_draws(
    ros_master: RosMaster, robots: Iterator[int], viewer: Callable[..., Viewer]
) -> None:
    arena, robot = Arena(), next(robots)
    try:
        with Hardware(arena, "virtual1") as hardware:
            assert hardware.line() == "light 0"
            tell_camera(ros_master, robot, f"{arena.page}eyes/virtual1")
            slow = viewer()
            slow.draws = False
            slow.watch(robot)
            with again_and_again(lambda: slow.say("seen"), DRAWING):
                full = painted(slow)
                until(lambda: painted(slow) < 0.7 * full, what="fewer pictures")
                fewer = painted(slow)
                quick = viewer()  # only now: it answers no ping until it is read from
                quick.watch(robot)
                with again_and_again(quick.drain, PAUSE):
                    until(lambda: painted(slow) > 1.3 * fewer, what="more pictures")
            assert [state for _, state, _ in slow.states] in (["live"], ["waiting", "live"])
    finally:
        assert arena.program.stop() == 0
