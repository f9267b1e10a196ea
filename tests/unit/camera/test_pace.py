"""A camera is asked for what its fastest viewer can show. Viewers here take their time to draw each picture."""

from collections import deque

import pytest

from server.access.identity import GUEST
from server.camera.pace import Pace
from server.camera.picture import Picture
from server.camera.viewer import Viewer

FULL = 20
STEP = 0.01  # s
TICK = 0.5  # s


class Hall:
    """A camera, and viewers that draw so many pictures/s."""

    def __init__(self, *speeds: float, most: float = FULL) -> None:
        """The camera sends `most` pictures/s, whatever it is asked for."""
        self.pace = Pace()
        self.most = most
        self.now = 0.0
        self.speeds: dict[Viewer, float] = {}
        self._drawing: dict[Viewer, deque[float]] = {}  # when each picture that is on its way will have been drawn
        self._due = self._tick = 0.0
        for speed in speeds:
            self.join(speed)

    def join(self, speed: float) -> Viewer:
        viewer = Viewer(GUEST, "1.2.3.4")
        viewer.turn(3, None, self.now)
        self.speeds[viewer], self._drawing[viewer] = speed, deque()
        self.pace.restart()
        return viewer

    def rates(self, seconds: float) -> list[int]:
        """Those that are asked for, one after the other."""
        asked = [self.pace.rate]
        end = self.now + seconds
        while self.now < end:
            self.now += STEP
            self._step()
            if self.pace.rate != asked[-1]:
                asked.append(self.pace.rate)
        return asked

    def _step(self) -> None:
        comes = self.now >= self._due
        if comes:
            self._due += 1 / min(self.pace.rate or FULL, self.most)
        for viewer, speed in self.speeds.items():
            if comes:
                viewer.offer(Picture(3, 1, self.now, True, b"jpeg"), self.now)
            self._draw(viewer, speed)
        if self.now >= self._tick:
            self._tick += TICK
            for viewer in self.speeds:
                viewer.mark(self.now)
        if comes:
            shown = max(viewer.rate(self.now) for viewer in self.speeds)
            self.pace.judge(FULL, shown, max(viewer.complete(self.now) for viewer in self.speeds), self.now)

    def _draw(self, viewer: Viewer, speed: float) -> None:
        drawing = self._drawing[viewer]
        if drawing and drawing[0] <= self.now:
            drawing.popleft()
            viewer.seen()
        if viewer.is_hungry:
            viewer.take()
            drawing.append((drawing[-1] if drawing else self.now) + 1 / speed)


@pytest.mark.parametrize(
    ("speed", "rates"), [(30, [0]), (13, [0]), (6.5, [0]), (5, [0, 10]), (2.5, [0, 5]), (0.5, [0, 5])]
)
def test_the_rate_is_what_the_viewer_can_show_and_stays(speed: float, rates: list[int]) -> None:
    """Whoever draws at one of the rates, or just above or below it, too: nothing goes up and down."""
    assert Hall(speed).rates(60) == rates


@pytest.mark.parametrize("tenths", range(5, 300, 3))
def test_no_speed_makes_the_rate_go_up_and_down(tenths: int) -> None:
    assert len(Hall(tenths / 10).rates(60)) <= 3


def test_the_fastest_viewer_counts() -> None:
    assert Hall(2, 30, 5).rates(20) == [0]
    assert Hall(2, 5).rates(20) == [0, 10]


def test_a_viewer_that_becomes_faster_gets_all_within_about_a_second() -> None:
    hall = Hall(2.5)
    assert hall.rates(20) == [0, 5]
    (viewer,) = hall.speeds
    hall.speeds[viewer] = 30
    assert hall.rates(1.5) == [5, 0]


def test_a_new_viewer_gets_all_at_once() -> None:
    hall = Hall(2.5)
    assert hall.rates(20) == [0, 5]
    hall.join(30)
    assert hall.rates(20) == [0]


def test_a_viewer_that_is_slow_for_a_moment_changes_nothing() -> None:
    hall = Hall(30)
    (viewer,) = hall.speeds
    for _ in range(5):
        hall.speeds[viewer] = 2
        assert hall.rates(4) == [0]
        hall.speeds[viewer] = 30
        assert hall.rates(4) == [0]


def test_a_camera_that_sends_few_pictures_has_no_slow_viewers_for_that() -> None:
    assert Hall(30, most=4).rates(20) == [0]
