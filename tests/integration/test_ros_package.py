"""The ROS packages: what genpy makes of them, and that ROS users can build them with catkin and see their types."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from rosapi.srv import MessageDetails, Topics

from laser_bot_battle.msg import GameStatus, Robot_msg, UserStatus
from laser_bot_battle.names import Game
from laser_bot_battle.srv import AddNewRobot
from tests.support.programs import ROOT


def test_md5_sums_are_those_of_the_contract() -> None:
    assert Robot_msg._md5sum == "aa81278360e1bdd1ffce0a4efe0ae199"
    assert AddNewRobot._md5sum == "0cb5143ed23a5de01874507c8711c4d5"


def test_the_states_of_the_game_have_the_messages_numbers() -> None:
    constants = (GameStatus.STOPPED, GameStatus.COUNTDOWN, GameStatus.PLAYING)
    assert constants == (Game.STOPPED, Game.COUNTDOWN, Game.PLAYING)
    page = (ROOT / "server/static/js/battle/state.js").read_text()
    assert tuple(map(int, re.findall(r"^export const (?:STOPPED|COUNTDOWN|PLAYING) = (\d);", page, re.M))) == constants


def test_a_command_is_three_bytes_on_the_wire(tmp_path: Path) -> None:
    wire = tmp_path / "wire"
    with wire.open("wb") as stream:
        Robot_msg(linear_x=-1, angular_z=1, shoot=True).serialize(stream)
    assert wire.read_bytes() == b"\xff\x01\x01"


# of somebody who calls rosapi from a package of their own
CALLER = {
    "package.xml": """<package format="2"><name>caller</name><version>0.0.0</version><description>calls</description>
        <maintainer email="a@example.org">a</maintainer><license>BSD</license>
        <buildtool_depend>catkin</buildtool_depend><depend>rosapi</depend></package>""",
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.5)
        project(caller)
        find_package(catkin REQUIRED COMPONENTS rosapi)
        catkin_package(CATKIN_DEPENDS rosapi)""",
}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A catkin workspace of our packages and one that depends on rosapi, built."""
    path = tmp_path_factory.mktemp("catkin")
    shutil.copytree(ROOT / "laser_bot_battle", path / "src" / "laser_bot_battle")
    shutil.copytree(ROOT / "server" / "rosapi", path / "src" / "rosapi")
    (path / "src" / "caller").mkdir()
    for name, text in CALLER.items():
        (path / "src" / "caller" / name).write_text(text)
    built = subprocess.run(
        ["catkin_make", "-C", str(path), "-DPYTHON_EXECUTABLE=/usr/bin/python3"],
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    return path


def run_in(workspace: Path, *command: str) -> str:
    """What a command prints that is run after `source devel/setup.sh`."""
    sourced = subprocess.run(
        ["sh", "-c", '. devel/setup.sh && exec "$@"', "sh", *command],
        cwd=workspace,
        env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"},
        capture_output=True,
        text=True,
        timeout=30,
        check=True,
    )
    return sourced.stdout


@pytest.mark.slow
def test_catkin_make_builds_the_same_messages(workspace: Path) -> None:
    script = (
        "from laser_bot_battle.msg import *; from laser_bot_battle.srv import *; import laser_bot_battle.master\n"
        "from rosapi.srv import Topics, MessageDetails\n"
        "print(*(each._md5sum for each in (Robot_msg, UserStatus, GameStatus, AddNewRobot, Topics, MessageDetails)))"
    )
    printed = run_in(workspace, "/usr/bin/python3", "-c", script).split()
    ours = (Robot_msg, UserStatus, GameStatus, AddNewRobot, Topics, MessageDetails)
    assert printed == [kind._md5sum for kind in ours]
    for header in ("laser_bot_battle/Robot_msg.h", "rosapi/Topics.h", "rosapi/TypeDef.h"):
        assert (workspace / "devel" / "include" / header).exists()


@pytest.mark.slow
def test_catkin_builds_every_type_of_rosapi(workspace: Path) -> None:
    built = {path.stem for path in (workspace / "devel" / "include" / "rosapi").iterdir()}
    sources = [*(ROOT / "server/rosapi/msg").iterdir(), *(ROOT / "server/rosapi/srv").iterdir()]
    assert {path.stem for path in sources} <= built


@pytest.mark.slow
def test_ros_tools_show_the_types_with_a_workspace_and_without(workspace: Path) -> None:
    assert run_in(workspace, "rossrv", "show", "rosapi/Topics") == "---\nstring[] topics\nstring[] types\n\n"
    environment = {**os.environ, "ROS_PACKAGE_PATH": str(ROOT)}  # as the README says
    for command, shown in (
        (["rossrv", "show", "rosapi/GetTime"], "---\ntime time\n\n"),
        (["rossrv", "show", "laser_bot_battle/AddNewRobot"], "---\nint8 ID\n\n"),
        (["rosmsg", "show", "-r", "rosapi/TypeDef"], (ROOT / "server/rosapi/msg/TypeDef.msg").read_text() + "\n"),
    ):
        assert subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout == shown
