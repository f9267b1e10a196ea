"""rosbridge open to everybody, as in a lab, with other people's client libraries and message packages."""

import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from tests.integration.rosbridge.client_programs import told_by
from tests.integration.rosbridge.conftest import Rosbridge
from tests.support.programs import ROOT, Program
from tests.support.ros import RosMaster
from tests.support.roslib_player import NODE

HERE = ROOT / "tests" / "integration" / "rosbridge"
PREEMPTED, SUCCEEDED = 2, 3  # actionlib_msgs/GoalStatus
NUMBERS = [0.5, -2.0, 1e6]
TOLD = {
    "said": 21,
    "none": NUMBERS,
    "calls": {"success": True, "message": "grüß Gott"},
    "serves": {"success": True, "message": "from the page"},
    "param": {"speeds": [1, 2.5], "name": "zwölf"},
    "param is left": False,
    "type": "std_msgs/String",
    "node": True,
    "action": [[1, 2, 3], SUCCEEDED, 3],
    "cancelled": PREEMPTED,
    "acts": [[1], SUCCEEDED, 3],
    "tf": 1.5,
    "tf topic": "robot",
}


@pytest.fixture(scope="module")
def message_path(ros_master: RosMaster, tmp_path_factory: pytest.TempPathFactory) -> str:
    """PYTHONPATH with the message package tf2_web_republisher, which Debian has not."""
    package = "tf2_web_republisher"
    folder = tmp_path_factory.mktemp("messages")
    sources = HERE / package
    includes = [f"-I{name}:/usr/share/{name}/msg" for name in ("std_msgs", "geometry_msgs", "actionlib_msgs")]
    for script, kind in (("genmsg_py.py", "msg"), ("gensrv_py.py", "srv")):
        command = ["/usr/bin/python3", f"/usr/lib/genpy/{script}"]
        target = ["-p", package, "-o", str(folder / package / kind)]
        files = sorted(map(str, (sources / kind).iterdir()))
        subprocess.run([*command, *files, f"-I{package}:{sources / 'msg'}", *includes, *target], check=True)
        subprocess.run([*command, "--initpy", *target], check=True)
    return f"{folder}:{ros_master.env['PYTHONPATH']}"


@pytest.fixture(scope="module")
def lab(ros_master: RosMaster, message_path: str) -> Iterator[None]:
    """The lab's ROS programs."""
    command = [sys.executable, "-m", "tests.integration.rosbridge.lab_side"]
    program = Program(command, {**ros_master.env, "PYTHONPATH": message_path})
    program.wait_for("ready")
    yield
    program.stop()


@pytest.fixture(scope="module")
def port(start_rosbridge: Callable[..., Rosbridge], message_path: str, lab: None) -> str:
    """Of the open rosbridge."""
    return str(start_rosbridge(LASERBOT_ROSBRIDGE_OPEN="1", PYTHONPATH=message_path).port)


def without_failure(told: dict[str, Any]) -> dict[str, Any]:
    """The service's own words must be the end of what the library says of its failure."""
    assert told.pop("failure").endswith("not today")
    return told


@pytest.mark.parametrize("library", ["roslib", "roslib1"])
def test_roslib_does_all_that_it_can(port: str, library: str) -> None:
    told = told_by(Program([str(NODE), str(HERE / "roslib_lab.mjs"), library, port]))
    assert without_failure(told) == {**TOLD, "png": NUMBERS, "cbor": NUMBERS}


@pytest.mark.slow
@pytest.mark.parametrize("library", ["@foxglove/roslibjs", "@lichtblick/roslibjs"])
def test_forks_of_roslib_do_the_same(port: str, library: str) -> None:
    """They have no client for tf."""
    told = told_by(Program([str(NODE), str(HERE / "roslib_lab.mjs"), library, port]))
    without_tf = {name: value for name, value in TOLD.items() if name != "tf"}
    assert without_failure(told) == {**without_tf, "png": NUMBERS, "cbor": NUMBERS}


@pytest.mark.parametrize("transport", ["twisted", "asyncio"])
def test_roslibpy_does_all_that_it_can(port: str, transport: str) -> None:
    command = [sys.executable, "-m", "tests.integration.rosbridge.roslibpy_lab", port]
    assert without_failure(told_by(Program(command, {"ROSLIBPY_TRANSPORT": transport}))) == TOLD
