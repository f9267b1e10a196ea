"""The two client libraries that rosbridge is made for."""

import sys

from tests.integration.rosbridge.client_programs import told_by
from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import RosSide
from tests.support.programs import ROOT, Program
from tests.support.roslib_player import NODE


def test_roslib_in_node_watches_calls_publishes_and_drives(rosbridge: Rosbridge, ros: RosSide) -> None:
    ros.status(1)
    refused = "only operators may call /add_new_robot"
    script = ROOT / "tests" / "integration" / "rosbridge" / "roslib_client.mjs"
    assert told_by(Program([str(NODE), str(script), str(rosbridge.port)])) == {
        "guest watches": 1,
        "guest calls": {"error": refused},
        "operator calls": {"response": {"ID": 7}},
        "failure": {"error": "service cannot process request: no robot is left"},
        "operator hears": "grüß Gott",
        "robot hears": {"linear_x": 1, "angular_z": -1, "shoot": False},
    }


def test_roslibpy_watches_calls_and_publishes(rosbridge: Rosbridge, ros: RosSide) -> None:
    ros.status(1)
    program = [sys.executable, "-m", "tests.integration.rosbridge.roslibpy_client", str(rosbridge.port)]
    assert told_by(Program(program)) == {
        "guest watches": 1,
        "operator calls": {"ID": 7},
        "operator hears": "AQL/",
        "header": {"secs": 5, "nsecs": 6},
    }
