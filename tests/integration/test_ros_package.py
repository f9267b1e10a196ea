"""The ROS package: what genpy makes of it, and that ROS users can build it with catkin."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

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


@pytest.mark.slow
def test_catkin_make_builds_the_same_messages(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "laser_bot_battle", tmp_path / "src" / "laser_bot_battle")
    built = subprocess.run(
        ["catkin_make", "-C", str(tmp_path), "-DPYTHON_EXECUTABLE=/usr/bin/python3"],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    script = (
        "from laser_bot_battle.msg import *; from laser_bot_battle.srv import *; import laser_bot_battle.master\n"
        "print(Robot_msg._md5sum, UserStatus._md5sum, GameStatus._md5sum, AddNewRobot._md5sum)"
    )
    printed = subprocess.run(
        ["sh", "-c", '. devel/setup.sh && exec /usr/bin/python3 -c "$0"', script],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=30,
        check=True,
    ).stdout.split()
    assert printed == [message._md5sum for message in (Robot_msg, UserStatus, GameStatus, AddNewRobot)]
    assert (tmp_path / "devel" / "include" / "laser_bot_battle" / "Robot_msg.h").exists()
