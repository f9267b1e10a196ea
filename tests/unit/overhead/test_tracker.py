"""The tracker against a camera whose place and lens are known."""

import math
import re
from collections.abc import Mapping

import numpy as np
import pytest

from laser_bot_battle.apriltag import Detection
from laser_bot_battle.geometry import FULL_SPEED, Pose
from laser_bot_battle.tags import FLOOR_TAG_SIZE, ROBOT_TAG_SIZE, floor_tags
from server.overhead.tracker import Tracker
from server.overhead.view import View, has_moved
from tests.support.overhead_camera import SIZE, TAG_HEIGHT, Floor, OverheadCamera

FRAME = 1 / 15  # s from one picture to the next
ROBOTS = {1: (0.3, 0.4, 0.5), 2: (3.7, 2.0, -2.0), 3: (2.0, 1.0, math.pi)}
Poses = Mapping[int, tuple[float, float, float]]


class Watch:
    """A tracker that sees what a camera sees, picture by picture."""

    def __init__(self, camera: OverheadCamera) -> None:
        self.camera, self.now = camera, 1000.0
        self.tracker = Tracker(camera.floor, camera.z, TAG_HEIGHT)

    def see(self, detections: list[Detection], pictures: int = 3) -> None:
        for _ in range(pictures):
            self.now += FRAME
            self.tracker.see(detections, SIZE, self.now)

    def look(self, poses: Poses = ROBOTS, pictures: int = 3) -> None:
        for _ in range(pictures):
            self.see(self.camera.floor_tags() + self.camera.robots(poses), 1)

    @property
    def places(self) -> dict[int, Pose]:
        return {seen.robot: seen.place for seen in self.tracker.robots(self.now)}

    @property
    def covered(self) -> list[int]:
        return [seen.robot for seen in self.tracker.robots(self.now) if seen.covered]

    @property
    def troubles(self) -> str:
        return "; ".join(self.tracker.troubles(self.now).values())


@pytest.fixture
def watch() -> Watch:
    return Watch(OverheadCamera())


def miss(place: Pose, pose: tuple[float, float, float]) -> tuple[float, float]:
    """In mm and degrees."""
    turn = math.remainder(place.heading - pose[2], math.tau)
    return 1000 * math.dist(place.point, pose[:2]), abs(math.degrees(turn))


@pytest.mark.parametrize(
    "camera",
    [
        OverheadCamera(noise=0.15),
        OverheadCamera(x=2.3, y=0.8, tilt=15, turn=5, noise=0.15),
        OverheadCamera(tilt=-15, bend=-0.15, noise=0.15),
        OverheadCamera(turn=180, bend=-0.15, noise=0.15, print_scale=0.98),
        OverheadCamera(floor=Floor(1.6, 1.2), x=0.9, y=0.5, z=1.6, noise=0.15),
    ],
    ids=["straight", "tilted", "bent", "upside down, printed too small", "small"],
)
def test_robots_are_found_to_millimetres_through_lens_tilt_and_noise(camera: OverheadCamera) -> None:
    watch = Watch(camera)
    poses = {
        robot: (x * camera.floor.width / 4, y * camera.floor.height / 2.25, h) for robot, (x, y, h) in ROBOTS.items()
    }
    watch.look(poses)
    assert watch.places.keys() == poses.keys()
    for robot, place in watch.places.items():
        away, turned = miss(place, poses[robot])
        assert away < 3
        assert turned < 1
    assert not watch.troubles


def test_what_stands_on_the_floor_is_not_taken_to_lie_there() -> None:
    """A tag 11 cm high, 2 m beside a camera at 2.5 m, would else be 9 cm off."""
    watch = Watch(OverheadCamera())
    flat = Tracker(watch.camera.floor, watch.camera.z, 0.0)
    for tick in range(3):
        flat.see(watch.camera.floor_tags() + watch.camera.robots(ROBOTS), SIZE, 1 + tick * FRAME)
    assert miss(flat.robots(1 + 2 * FRAME)[0].place, ROBOTS[1])[0] > 50


def test_the_floor_stays_known_while_feet_cover_all_of_its_tags_but_one(watch: Watch) -> None:
    watch.look()
    watch.see(watch.camera.floor_tags(without=range(200, 209)) + watch.camera.robots(ROBOTS), 60)
    assert watch.places.keys() == ROBOTS.keys()
    assert not watch.troubles


def test_a_pushed_camera_measures_the_floor_again(watch: Watch) -> None:
    watch.look()
    watch.tracker.news()
    watch.camera.x += 0.1
    watch.camera.tilt = 3
    watch.look(pictures=12)
    assert [news.partition(":")[0] for news in watch.tracker.news()] == [
        "the camera has been moved",
        "the floor is known by 10 of its tags",
    ]
    assert miss(watch.places[1], ROBOTS[1])[0] < 3


def test_where_the_floor_is_in_the_picture_is_news_when_the_camera_was_pushed_and_not_with_each_measurement() -> None:
    watch = Watch(OverheadCamera(tilt=10, bend=-0.1, noise=0.1))
    views: list[View | None] = [None]
    for pushed in (0.0, 0.02):
        watch.camera.x += pushed
        for _ in range(120):  # 8 s: it is measured some times
            watch.look(pictures=1)
            if has_moved(views[-1], watch.tracker.view, watch.camera.floor):
                views.append(watch.tracker.view)
    assert len(views) == 3
    watch.camera.noise = 0
    places = np.array([(0.1, 0.2, 0), (3.9, 2, 0), (2, 0, 0)])
    last = views[-1]
    assert last is not None
    assert np.abs(last.pixels(places[:, :2]) - watch.camera.pixels(places)).max() < 1
    assert has_moved(last, None, watch.camera.floor)


def test_a_pushed_camera_tells_no_places_until_it_knows_the_floor_again(watch: Watch) -> None:
    watch.look()
    watch.camera.x += 0.1
    watch.see(watch.camera.floor_tags(without=range(200, 207)) + watch.camera.robots(ROBOTS), 12)
    assert not watch.places
    assert "of its tags only 207, 208, 209 can be seen, of 4 that are needed" in watch.troubles


def test_one_tag_that_lies_wrong_is_named_and_left_out(watch: Watch) -> None:
    tags = watch.camera.floor_tags(without=[205])
    moved = watch.camera.tag(205, (4.0, 2.4, 0), FLOOR_TAG_SIZE)
    watch.see([*tags, moved, *watch.camera.robots(ROBOTS)])
    assert miss(watch.places[2], ROBOTS[2])[0] < 3
    assert watch.troubles == "floor tag 205 lies 15 cm from its place: put it back"


@pytest.mark.parametrize(
    ("seen", "trouble"),
    [
        ([], "none of its tags .* is seen"),
        ([200], "only 200 can be seen, of 4"),
        ([200, 201, 202], "that are seen, 200, 201, 202, lie in a line: uncover one of 203"),
        ([200, 201, 202, 203], "that are seen, 200, 201, 202, 203, lie in a line: uncover one of 204"),
        ([200, 203, 205], "only 200, 203, 205 can be seen, of 4"),
    ],
)
def test_too_few_floor_tags_are_refused_and_say_why(watch: Watch, seen: list[int], trouble: str) -> None:
    hidden = [number for number in floor_tags(watch.camera.floor) if number not in seen]
    watch.see(watch.camera.floor_tags(without=hidden) + watch.camera.robots(ROBOTS))
    assert not watch.places
    assert re.search(trouble, watch.troubles)


def test_tags_that_lie_anywhere_are_no_floor(watch: Watch) -> None:
    watch.camera.turn = 180
    numbers = [each.number for each in watch.camera.floor_tags()]
    mixed = [
        each._replace(number=number)
        for each, number in zip(watch.camera.floor_tags(), numbers[3::2] + numbers[::3], strict=False)
    ]
    watch.see(mixed)
    assert not watch.places
    assert "do not lie as planned" in watch.troubles


def test_no_garbage_ends_the_tracker() -> None:
    random = np.random.default_rng(5)
    watch = Watch(OverheadCamera())
    for scale in (1e-9, 1, 1e3, 1e9) * 5:
        corners = random.normal(0, scale, (6, 4, 2)) * random.integers(0, 2, (6, 1, 1))
        watch.see([Detection(200 + index, tuple(map(tuple, each)), 50.0) for index, each in enumerate(corners)], 1)  # type: ignore[arg-type]
        watch.now += 1
    assert watch.tracker.view is None


def test_a_pushed_camera_is_told_even_when_a_measurement_was_due(watch: Watch) -> None:
    watch.look()
    watch.tracker.news()
    watch.now += 10
    watch.camera.x += 0.1
    watch.look(pictures=8)
    assert "the camera has been moved" in "".join(watch.tracker.news())


def test_a_covered_robot_is_where_its_commands_take_it_for_a_second(watch: Watch) -> None:
    watch.look()
    began, (x, y, heading) = watch.now, ROBOTS[1]
    while watch.now - began < 0.9:
        watch.tracker.command(1, 1, 0, watch.now)
        watch.see(watch.camera.floor_tags() + watch.camera.robots({2: ROBOTS[2]}), 1)
    driven = FULL_SPEED * (watch.now - began)
    there = (x + driven * math.cos(heading), y + driven * math.sin(heading), heading)
    assert miss(watch.places[1], there)[0] < 3
    assert watch.covered == [1, 3]
    watch.see(watch.camera.floor_tags() + watch.camera.robots({2: ROBOTS[2]}), 3)
    assert watch.places.keys() == {2}
    watch.look({**ROBOTS, 1: there}, pictures=3)
    assert watch.places.keys() == ROBOTS.keys()
    assert watch.covered == []


def test_a_robot_is_not_covered_because_the_host_is_slow_but_when_pictures_stay_away(watch: Watch) -> None:
    watch.look()
    assert not any(seen.covered for seen in watch.tracker.robots(watch.now + 0.5))
    assert all(seen.covered for seen in watch.tracker.robots(watch.now + 0.7))
    assert not watch.tracker.robots(watch.now + 1.1)


def test_between_pictures_a_robot_is_where_its_commands_take_it(watch: Watch) -> None:
    """A full turn takes 5 s: in the 0.1 s until a picture is looked at, 7 degrees."""
    watch.look()
    watch.tracker.command(3, 0, -1, watch.now)
    (place,) = (seen.place for seen in watch.tracker.robots(watch.now + 0.1) if seen.robot == 3)
    assert miss(place, ROBOTS[3])[1] == pytest.approx(math.degrees(2 * FULL_SPEED / 0.12) * 0.1, abs=0.1)
    assert math.remainder(place.heading - ROBOTS[3][2], math.tau) > 0


def test_a_single_false_detection_moves_no_robot_and_makes_none(watch: Watch) -> None:
    watch.look()
    false = watch.camera.robots({1: (3.0, 2.0, 0), 77: (1, 1, 1)})
    watch.see(watch.camera.floor_tags() + watch.camera.robots({2: ROBOTS[2], 3: ROBOTS[3]}) + false, 1)
    assert watch.places.keys() == ROBOTS.keys()
    assert miss(watch.places[1], ROBOTS[1])[0] < 3


def test_a_robot_that_is_carried_elsewhere_is_there_after_three_pictures(watch: Watch) -> None:
    watch.look()
    there = {**ROBOTS, 1: (3.0, 2.0, 0.0)}
    watch.look(there, pictures=2)
    assert miss(watch.places[1], ROBOTS[1])[0] < 3
    watch.look(there, pictures=1)
    assert miss(watch.places[1], there[1])[0] < 3


def test_unknown_doubled_and_wrongly_printed_tags_are_told_by_number(watch: Watch) -> None:
    watch.look()
    wrong = [
        watch.camera.tag(300, (1, 1, 0), ROBOT_TAG_SIZE),
        watch.camera.tag(200, (2, 2, 0), FLOOR_TAG_SIZE),
        *watch.camera.robots({1: (3.0, 2.0, 0)}),
        watch.camera.tag(5, (1, 2, 0), 0.06, TAG_HEIGHT),
    ]
    watch.see(watch.camera.floor_tags() + watch.camera.robots(ROBOTS) + wrong)
    assert set(watch.tracker.troubles(watch.now).values()) == {
        "tag 300 belongs to no robot and not to this floor",
        "floor tag 200 is seen 2 times: take away all but the one at its place",
        "robot tag 1 is seen 2 times: only one robot may carry it",
        "robot tag 5 seems 6 cm wide, not 10: print it in its true size, or set how high the camera and the tags are",
    }
    assert miss(watch.places[1], ROBOTS[1])[0] < 3  # the one that was there before
    assert 5 not in watch.places
    watch.now += 2
    assert not watch.troubles


def test_what_hardly_differs_from_noise_is_no_tag(watch: Watch) -> None:
    watch.see([each._replace(margin=5.0) for each in watch.camera.floor_tags()])
    assert not watch.tracker.floor_tags


def test_ten_thousand_false_detections_do_no_harm(watch: Watch) -> None:
    watch.look()
    random = np.random.default_rng(2)
    false = [
        Detection(int(number), tuple(map(tuple, corners)), 50.0)  # type: ignore[arg-type]
        for number, corners in zip(
            random.integers(0, 587, 10_000), random.uniform(-100, 1400, (10_000, 4, 2)), strict=True
        )
    ]
    watch.see(watch.camera.floor_tags() + watch.camera.robots(ROBOTS) + false)
    assert watch.places.keys() == ROBOTS.keys()
    assert all(miss(watch.places[robot], ROBOTS[robot])[0] < 3 for robot in ROBOTS)
    assert watch.tracker.view is not None


def test_robots_that_crowd_are_never_taken_for_each_other() -> None:
    watch = Watch(OverheadCamera(noise=0.15))
    random = np.random.default_rng(3)
    for _ in range(300):
        angle = watch.now * 0.5
        poses = {
            robot: (2 + 0.1 * math.cos(angle + robot * 2.1), 1.1 + 0.1 * math.sin(angle + robot * 2.1), angle)
            for robot in (1, 2, 3)
        }
        hidden = int(random.integers(0, 6))
        watch.look({robot: pose for robot, pose in poses.items() if robot != hidden}, pictures=1)
        for robot, place in watch.places.items():
            assert miss(place, poses[robot])[0] < 60


NEXT_DOOR = OverheadCamera(floor=Floor(3.0, 1.5), x=1.5, y=0.7, z=2.0)
ELSEWHERE = {robot: (x * 0.5, y * 0.5, heading) for robot, (x, y, heading) in ROBOTS.items()}


@pytest.mark.parametrize(
    ("floor_tags", "trouble"),
    [([], "none of its tags"), (NEXT_DOOR.floor_tags(), "the picture of the camera above the floor")],
    ids=["without a floor", "of another floor"],
)
def test_the_picture_of_another_camera_puts_no_robot_anywhere(
    watch: Watch, floor_tags: list[Detection], trouble: str
) -> None:
    """It shows the same robots, or other ones with these numbers."""
    watch.look()
    for number in range(30):
        watch.see(floor_tags + NEXT_DOOR.robots(ELSEWHERE), 1)
        assert all(miss(place, ROBOTS[robot])[0] < 3 for robot, place in watch.places.items()), "where they were"
        if number == 4:
            assert [seen.covered for seen in watch.tracker.robots(watch.now)] == [True] * len(watch.places)
    assert watch.places == {}
    assert watch.tracker.view is None
    assert trouble in watch.troubles
    watch.look(pictures=12)
    assert watch.places.keys() == ROBOTS.keys()


def test_pictures_of_another_size_are_measured_anew(watch: Watch) -> None:
    watch.look()
    watch.tracker.see([], (640, 480), watch.now + FRAME)
    assert watch.tracker.view is None
    assert "640 x 480" in "".join(watch.tracker.news())
