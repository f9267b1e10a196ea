"""From the tags of each picture to where the robots are. Pure: pictures, commands and the time in, places out.

Times in s, of a clock that only goes on.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from laser_bot_battle.apriltag import Detection
from laser_bot_battle.geometry import Pose
from laser_bot_battle.names import ROBOT_IDS
from laser_bot_battle.tags import ROBOT_TAG_SIZE, Rectangle, floor_tags
from server.overhead.floor_sight import FloorSight
from server.overhead.robots import Robots, Seen
from server.overhead.troubles import Troubles
from server.overhead.view import Floats, Size, View

OUTSIDE = 0.2  # m from the floor at which a robot is still one: it may lean over the edge
# the edges of a robot's tag, in its true size: noise, a wrong height and a bad print change that by less
SMALLEST, LARGEST = 0.8, 1.25
UNEVEN = 1.25  # one edge to another, of what is no square that lies flat
SURE = 10.0  # between black and white, of 255: less is noise that happens to look like a tag


class Tracker:
    """For one thread."""

    def __init__(self, floor: Rectangle, camera_height: float, tag_height: float) -> None:
        """Heights in m over the floor: of the camera, and of the tags on robots."""
        self._floor, self._tag_height = floor, tag_height
        self._places = floor_tags(floor)
        self._troubles = Troubles()
        self._sight = FloorSight(self._places, camera_height, self._troubles)
        self._robots = Robots()
        self.floor_tags: list[int] = []
        """numbers of those in the last picture"""

    @property
    def view(self) -> View | None:
        """How the camera sees the floor; None: where that is in the picture is not known."""
        return self._sight.view

    def command(self, robot: int, linear_x: int, angular_z: int, now: float) -> None:
        """A robot is told to move so (Robot_msg)."""
        self._robots.command(robot, linear_x, angular_z, now)

    def see(self, detections: Iterable[Detection], size: Size, taken: float) -> None:
        """The tags in the picture that was taken then."""
        by_number: dict[int, list[Floats]] = {}
        for detection in detections:
            if detection.margin >= SURE:
                by_number.setdefault(detection.number, []).append(np.array(detection.corners))
        for number in sorted(by_number.keys() - self._places.keys() - set(ROBOT_IDS)):
            self._troubles.notice(("unknown", number), f"tag {number} belongs to no robot and not to this floor", taken)
        floor = {number: by_number[number] for number in self._places if number in by_number}
        for number, several in floor.items():
            if len(several) > 1:
                text = f"floor tag {number} is seen {len(several)} times: take away all but the one at its place"
                self._troubles.notice(("twice", number), text, taken)
        clear = {number: several[0] for number, several in floor.items() if len(several) == 1}
        self.floor_tags = sorted(clear)
        self._sight.see(clear, size, taken)
        if self._sight.view is None:
            self._robots.forget()
            return
        # it may be another camera's picture: then it shows none of the robots
        shown = ROBOT_IDS if self._sight.is_sure else ()
        robots = {number: several for number, several in by_number.items() if number in shown}
        self._robots.see(self._robot_places(self._sight.view, robots, taken), taken)

    def robots(self, now: float) -> list[Seen]:
        """Where they are now."""
        return self._robots.at(now)

    def troubles(self, now: float) -> dict[object, str]:
        """What is wrong, for people, by what tells it from other troubles."""
        return self._troubles.believed(now)

    def news(self) -> list[str]:
        """What has happened since this was last asked, for the log."""
        news, self._sight.measurements = self._sight.measurements, []
        return news

    def _robot_places(self, view: View, robots: Mapping[int, Sequence[Floats]], taken: float) -> dict[int, list[Pose]]:
        """Of the tags that can be robots'."""
        numbers = [number for number, several in robots.items() for _ in several]
        if not numbers:
            return {}
        pixels = np.concatenate([corners for several in robots.values() for corners in several])
        corners = view.places(pixels, self._tag_height).reshape(-1, 4, 2)
        edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        middles = corners.mean(axis=1)
        up = corners[:, 2] + corners[:, 3] - corners[:, 0] - corners[:, 1]
        headings = np.arctan2(up[:, 1], up[:, 0])
        places: dict[int, list[Pose]] = {}
        for number, edge, middle, heading in zip(numbers, edges, middles, headings, strict=True):
            x, y = middle
            on_floor = -OUTSIDE <= x <= self._floor.width + OUTSIDE and -OUTSIDE <= y <= self._floor.height + OUTSIDE
            if not on_floor or not edge.max() <= UNEVEN * edge.min():
                continue
            if not SMALLEST <= edge.mean() / ROBOT_TAG_SIZE <= LARGEST:
                self._troubles.notice(
                    ("size", number),
                    f"robot tag {number} seems {edge.mean() * 100:.0f} cm wide, not {ROBOT_TAG_SIZE * 100:.0f}: "
                    "print it in its true size, or set how high the camera and the tags are",
                    taken,
                )
                continue
            places.setdefault(number, []).append(Pose(float(x), float(y), float(heading)))
        for number, several in places.items():
            if len(several) > 1:
                text = f"robot tag {number} is seen {len(several)} times: only one robot may carry it"
                self._troubles.notice(("twice", number), text, taken)
        return places
