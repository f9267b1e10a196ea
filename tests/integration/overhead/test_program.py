"""The tracker between a camera's stream and ROS."""

import json
import math
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import requests
from prometheus_client.parser import text_string_to_metric_families

from laser_bot_battle.floor import floor_file
from laser_bot_battle.names import (
    OVERHEAD_CAMERA,
    OVERHEAD_COVERED,
    OVERHEAD_STATUS,
    OVERHEAD_VIEW,
    POSITIONS,
    WATCHED,
    command_topic,
)
from server.overhead.view import View
from tests.integration.rosbridge.ends import COMMAND_TYPE, FORWARD, RosSide
from tests.support.documents import page, table
from tests.support.fake_camera import FakeCamera, with_headers
from tests.support.overhead_camera import Floor, OverheadCamera, grey_picture, jpeg_of
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster

ROBOTS = {1: (0.3, 0.4, 0.5), 2: (1.3, 0.9, -2.0)}  # on the floor `battle`
VIEW = OverheadCamera(floor=Floor(1.6, 1.2), x=0.8, y=0.6, z=2.4, focal_length=1.6)


class Hall:
    """A camera above the floor `battle`, the tracker, and who listens to it."""

    def __init__(self, master: RosMaster, folder: Path) -> None:
        self.floor = folder / "floor.json"
        shutil.copy(floor_file("battle"), self.floor)
        self.camera = FakeCamera(rate=15)
        self.camera.part = lambda _, __: with_headers(self.jpeg, f"Content-Length: {len(self.jpeg)}")
        self.show(ROBOTS)
        self.side = RosSide(master.env)
        self.side.listen(POSITIONS, "laser_bot_battle/Positions")
        self.side.listen(OVERHEAD_STATUS, "laser_bot_battle/OverheadStatus")
        self.side.listen(OVERHEAD_COVERED, "laser_bot_battle/OverheadCovered")
        self.side.listen("/tf", "tf2_msgs/TFMessage")
        self.side.listen(OVERHEAD_VIEW, "laser_bot_battle/OverheadView")
        self.side.listen(OVERHEAD_CAMERA, "std_msgs/String")
        self.metrics = free_port()
        self.program = Program.python(
            "server.overhead",
            env={
                **master.env,
                "LASERBOT_OVERHEAD_CAMERA": self.camera.url,
                "LASERBOT_FLOOR": str(self.floor),
                "LASERBOT_OVERHEAD_HEIGHT": str(VIEW.z),
                "LASERBOT_METRICS": f"127.0.0.1:{self.metrics - WATCHED.index('overhead')}",
            },
        )

    def show(self, robots: dict[int, tuple[float, float, float]]) -> None:
        """From now on, these are before the camera."""
        self.jpeg = jpeg_of(grey_picture(VIEW.floor_tags() + VIEW.robots(robots)))

    @property
    def positions(self) -> dict[int, dict[str, Any]]:
        """The robots of the newest message."""
        heard = self.side.heard(POSITIONS)
        return {one["robot"]: one for one in heard[-1]["robots"]} if heard else {}

    @property
    def status(self) -> dict[str, Any]:
        return (self.side.heard(OVERHEAD_STATUS) or [{}])[-1]

    def get(self, path: str) -> str:
        return requests.get(f"http://127.0.0.1:{self.metrics}{path}", timeout=LATEST).text


@pytest.fixture(scope="module")
def hall(ros_master: RosMaster, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hall]:
    hall = Hall(ros_master, tmp_path_factory.mktemp("hall"))
    try:
        with hall.camera:
            until(lambda: hall.positions.keys() == ROBOTS.keys(), 20, "places of the robots")
            yield hall
        assert hall.program.stop() == 0
        assert "Traceback" not in hall.program.output
    finally:
        hall.program.kill()
        hall.side.close()


def test_it_tells_ros_where_robots_are(hall: Hall) -> None:
    for robot, (x, y, heading) in ROBOTS.items():
        found = hall.positions[robot]
        assert math.dist((found["x"], found["y"]), (x, y)) < 0.005
        assert abs(math.remainder(found["heading"] - heading, math.tau)) < 0.03
    message = hall.side.heard(POSITIONS)[-1]
    assert (message["width"], message["height"]) == pytest.approx((1.6, 1.2))
    assert message["walls"][:4] == pytest.approx([0, 0, 1.6, 0])
    until(lambda: hall.status.get("places") and hall.status["robots"] == [1, 2], 10, "a status without troubles")
    assert hall.status["troubles"] == []
    assert hall.status["floor_tags"] == [200, 201, 202, 203, 204, 205]


def test_the_tools_of_ros_get_transforms(hall: Hall) -> None:
    until(lambda: hall.side.heard("/tf"), 10, "a transform")
    one = hall.side.heard("/tf")[-1]["transforms"][0]
    assert (one["header"]["frame_id"], one["child_frame_id"]) == ("floor", "robot1")
    assert one["transform"]["translation"]["x"] == pytest.approx(0.3, abs=0.005)
    assert 2 * math.asin(one["transform"]["rotation"]["z"]) == pytest.approx(0.5, abs=0.03)


def test_pages_can_lay_the_picture_flat_and_the_relay_knows_where_it_is(hall: Hall) -> None:
    until(lambda: any(view["width"] for view in hall.side.heard(OVERHEAD_VIEW)), 10, "a view")
    told = hall.side.heard(OVERHEAD_VIEW)[-1]
    assert (told["width"], told["height"], told["tag_height"]) == (1280, 720, pytest.approx(0.11))
    view = View((told["width"], told["height"]), np.reshape(told["homography"], (3, 3)), told["bend"], told["camera"])
    places = np.array([(0.1, 0.2, 0), (1.5, 1.1, 0)])
    assert np.abs(view.pixels(places[:, :2]) - VIEW.pixels(places)).max() < 1
    assert hall.side.heard(OVERHEAD_CAMERA) == [{"data": f"{hall.camera.url}/stream?extra_headers=1"}]


def test_a_covered_robot_moves_on_by_its_commands_and_is_marked(hall: Hall) -> None:
    def has_moved_on(by: float) -> bool:
        hall.side.publish(command_topic(1), COMMAND_TYPE, **FORWARD)
        return any(one["x"] > ROBOTS[1][0] + by for one in moves_of(hall, 1))

    # its picture stands still, but is a little older than the message
    until(lambda: has_moved_on(0.0015), 10, "its commands are heard")
    hall.show({2: ROBOTS[2]})

    def is_predicted() -> bool:
        return has_moved_on(0.01) and hall.side.heard(OVERHEAD_COVERED)[-1] == {"robots": [1]}

    until(is_predicted, 10, "a predicted place")
    until(lambda: hall.positions.keys() == {2}, 10, "no place any more")
    until(lambda: hall.side.heard(OVERHEAD_COVERED)[-1] == {"robots": []}, 10, "nor is it covered")
    hall.show(ROBOTS)
    until(lambda: hall.positions.keys() == ROBOTS.keys(), 10, "it is seen again")


def moves_of(hall: Hall, robot: int) -> list[dict[str, Any]]:
    return [one for message in hall.side.heard(POSITIONS) for one in message["robots"] if one["robot"] == robot]


def test_it_can_be_watched_as_the_page_says(hall: Hall) -> None:
    told = {
        (family.name + ("_total" if family.type == "counter" else ""), family.documentation)
        for family in text_string_to_metric_families(hall.get("/metrics"))
        if not family.name.startswith("process_")
    }
    rows = table(page("monitoring.md"), "Metrics")
    assert told == {(row["metric"], row["what"]) for row in rows if row["program"] == "overhead"}
    until(lambda: hall.get("/readyz") == "ok\n", 10, "it is ready")


def test_without_its_camera_it_says_so_and_goes_on_when_it_is_back(hall: Hall) -> None:
    hall.camera.stop()
    try:
        until(lambda: not hall.status["places"] and not hall.status["robots"], 10, "no places")
        told, said = len(hall.side.heard(POSITIONS)), len(hall.side.heard(OVERHEAD_STATUS))
        until(lambda: len(hall.side.heard(OVERHEAD_STATUS)) > said + 1, 10, "a second has passed")
        assert len(hall.side.heard(POSITIONS)) == told, (
            "pages say that positions have stopped, not that nobody is there"
        )
        (trouble,) = hall.status["troubles"]
        assert trouble.startswith(f"no picture of the camera above the floor ({hall.camera.url}/stream")
        assert trouble.endswith("the camera cannot be reached")
        assert trouble in hall.program.output
        assert hall.get("/healthz") == "ok\n"
        assert hall.get("/readyz") == f"{trouble}\n"
    finally:
        hall.camera.start()
    until(lambda: hall.positions.keys() == ROBOTS.keys(), 10, "places of the robots")
    assert hall.camera.requests[-1] == "GET /stream?extra_headers=1 HTTP/1.0"


def test_without_an_address_it_says_what_to_set() -> None:
    program = Program.python("server.overhead")
    until(lambda: not program.running, 20, "its end")
    assert program.process.returncode == 2
    assert "LASERBOT_OVERHEAD_CAMERA must say where the camera above the floor is" in program.output


def test_it_takes_another_floor_by_itself(hall: Hall) -> None:
    floor = json.loads(hall.floor.read_text())
    hall.floor.write_text(json.dumps({**floor, "walls": []}))
    until(lambda: len(hall.side.heard(POSITIONS)[-1]["walls"]) == 16, 20, "only the outer walls")
    until(lambda: hall.positions.keys() == ROBOTS.keys(), 20, "places of the robots")
