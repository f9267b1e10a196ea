"""The README's tables say what the code does."""

import json
import re

import yaml

from tests.support.programs import ROOT

README = (ROOT / "README.md").read_text()
SERVICES = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"]
VARIABLE = re.compile(r"\bLASERBOT_[A-Z]+(?:_[A-Z]+)*\b")


def test_every_variable_that_a_program_reads_is_in_the_table_and_no_other() -> None:
    sources = [
        path
        for folder in ("server", "robot", "sim", "ci", "laser_bot_battle")
        for path in (ROOT / folder).rglob("*")
        if path.suffix in {".py", ".launch", ".c", ""} and path.is_file() and "bundle" not in path.parts
    ]
    sources.append(ROOT / "compose.yaml")
    read = {name for path in sources for name in VARIABLE.findall(path.read_text())}
    rows = re.findall(r"^\| (`LASERBOT_[^|]+) \|", README, re.MULTILINE)
    listed = {name for row in rows for name in VARIABLE.findall(row)}
    assert listed == read


def test_compose_passes_ros_variables_to_robots_and_the_address_to_their_master() -> None:
    robot = SERVICES["robot"]["environment"]
    assert [robot[name] for name in ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME")] == [None] * 3, "as they are outside"
    for service in ("ros-master", "rosbridge", "web"):
        assert SERVICES[service]["environment"]["ROS_HOSTNAME"].startswith("${ROS_IP:-")


def test_every_folder_and_command_that_is_named_exists() -> None:
    for folder in re.findall(r"`(\w+(?:/\w+)*/)`", README):
        assert (ROOT / folder).is_dir() or (ROOT / "tests" / folder).is_dir(), folder
    targets = set(re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    assert set(re.findall(r"\bmake (\w+)", README)) <= targets


def test_there_is_one_version() -> None:
    version = re.search(r"<version>(.+)</version>", (ROOT / "laser_bot_battle/package.xml").read_text())[1]
    assert set(re.findall(r"LASERBOT_VERSION:-([^}]+)}", (ROOT / "compose.yaml").read_text())) == {version}
    assert json.loads((ROOT / "package.json").read_text())["version"] == version
    assert json.loads((ROOT / "package-lock.json").read_text())["version"] == version
