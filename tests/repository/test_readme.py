"""The README's tables say what the code does."""

import json
import re

import pytest
import yaml

from laser_bot_battle.variables import LASERBOT, table
from tests.support.imagefile import version
from tests.support.program_settings import ProgramSettings
from tests.support.programs import ROOT

README = (ROOT / "README.md").read_text()
VARIABLE = re.compile(r"\bLASERBOT_[A-Z]+(?:_[A-Z]+)*\b")
LISTED = {variable.name for variable in LASERBOT}
MARKED = {variable.name for variable in LASERBOT if "not with compose" in variable.text}
COMPOSE = (ROOT / "compose.yaml").read_text()
SERVICES = yaml.safe_load(COMPOSE)["services"]
INTERPOLATED = set(re.findall(r"\$\{(LASERBOT_\w+)", COMPOSE))


def test_the_page_of_the_settings_has_the_table_of_the_declarations() -> None:
    assert table() in (ROOT / "docs" / "settings.md").read_text()


def test_every_variable_that_a_program_reads_is_in_the_table_and_no_other() -> None:
    sources = [
        path
        for folder in ("server", "robot", "sim", "ci", "laser_bot_battle")
        for path in (ROOT / folder).rglob("*")
        if path.suffix in {".py", ".launch", ".c", ""} and path.is_file() and "bundle" not in path.parts
    ]
    sources.append(ROOT / "compose.yaml")
    read = {name for path in sources for name in VARIABLE.findall(path.read_text())}
    assert read == LISTED


def test_compose_takes_every_variable_of_the_table_but_those_that_are_marked() -> None:
    environments = [service.get("environment", {}) for service in SERVICES.values()]
    passed = {name for environment in environments for name, value in environment.items() if value is None}
    assert {name for name in passed if VARIABLE.fullmatch(name)} | INTERPOLATED == LISTED - MARKED


@pytest.mark.parametrize(
    "service, program",
    [
        ("rosbridge", "server.rosbridge"),
        ("web", "server.main"),
        ("camera-relay", "server.camera"),
        ("rosout", "server.ros.rosout"),
        ("front", "server.front"),
        ("bots", "server.bots"),
        ("announcer", "server.announcer"),
        ("overhead", "server.overhead"),
        ("entrance", "server.entrance"),
        ("robot", "robot.id_service_client"),
        ("camera", "robot.camera"),
    ],
)
def test_compose_gives_a_fleets_program_all_that_it_reads(service: str, program: str) -> None:
    read = ProgramSettings(["python3", "-m", program], {}).variables
    assert {name for name in read if VARIABLE.fullmatch(name)} - MARKED <= SERVICES[service]["environment"].keys()


def test_the_demo_of_compose_plays_with_coded_light_and_a_fleet_as_its_owner_says() -> None:
    light = {name: SERVICES[name]["environment"]["LASERBOT_LIGHT"] for name in ("demo-web", "web")}
    assert light == {"demo-web": "${LASERBOT_LIGHT:-coded}", "web": None}


def test_compose_passes_ros_variables_to_robots_and_the_address_to_their_master() -> None:
    """As they are outside: where there are none, the programs find them out."""
    assert SERVICES["robot"]["environment"]["ROS_MASTER_URI"] is None
    for service in ("ros-master", "rosbridge", "web", "camera-relay", "rosout", "robot"):
        assert [SERVICES[service]["environment"][name] for name in ("ROS_IP", "ROS_HOSTNAME")] == [None, None]


def test_the_desk_of_compose_writes_the_floors_that_others_only_read() -> None:
    """Their folder, not one file: a floor is put in another's place, which the others would not see."""
    mounts = {
        name: volume.removeprefix("./floors:/etc/laserbot/floors")
        for name, service in SERVICES.items()
        for volume in service.get("volumes", [])
        if "floors" in volume
    }
    assert mounts == {"web": "", "demo-web": "", "overhead": ":ro", "arena": ":ro"}


def test_there_is_one_version() -> None:
    assert set(re.findall(r"LASERBOT_VERSION:-([^}]+)}", COMPOSE)) == {version()}
    assert json.loads((ROOT / "package.json").read_text())["version"] == version()
    bake = (ROOT / "docker-bake.hcl").read_text()
    assert re.findall(r'variable "VERSION" { default = "(.*)" }', bake) == [version()]
    assert json.loads((ROOT / "package-lock.json").read_text())["version"] == version()
