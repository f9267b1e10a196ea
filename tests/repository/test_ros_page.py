"""docs/protocol-ros.md against the messages of the package and against a running battle."""

import re
from collections.abc import Iterator

import pytest
from std_msgs.msg import Empty

from laser_bot_battle.master import Master
from laser_bot_battle.msg import (
    BoardHealth,
    GameEvent,
    GameStatus,
    Health,
    Hit,
    OverheadCovered,
    OverheadStatus,
    OverheadView,
    Place,
    Positions,
    Robot_msg,
    RobotPosition,
    Setup,
    Shot,
    UserStatus,
)
from laser_bot_battle.srv import AddNewRobot
from tests.support.battle import Battle
from tests.support.documents import blocks, page, table
from tests.support.player import Player
from tests.support.polling import until
from tests.support.programs import ROOT

PAGE = page("protocol-ros.md")
KINDS = (
    AddNewRobot,
    BoardHealth,
    Empty,
    GameEvent,
    GameStatus,
    Health,
    Hit,
    OverheadCovered,
    OverheadStatus,
    OverheadView,
    Place,
    Positions,
    Robot_msg,
    RobotPosition,
    Setup,
    Shot,
    UserStatus,
)
TYPES = {kind._type: kind for kind in KINDS}
# what every ROS network has
USUAL = re.compile(r"/rosout|/rosout_agg|/diagnostics|/.*/(get_loggers|set_logger_level)")


def test_types_and_their_checksums_are_those_of_the_package() -> None:
    assert {row["type"]: row["md5"] for row in table(PAGE, "Types")} == {
        name: kind._md5sum for name, kind in TYPES.items()
    }


def test_the_definitions_are_those_of_the_package() -> None:
    """Name for name; the comments on the page are shorter."""
    for block in blocks(PAGE, "rosmsg"):
        name, definition = block.split("\n", 1)
        path = ROOT / "laser_bot_battle" / name.removeprefix("# laser_bot_battle/")

        def fields(text: str) -> list[str]:
            return [" ".join(line.split("#")[0].split()) for line in text.splitlines() if line.split("#")[0].strip()]

        assert fields(definition) == fields(path.read_text()), name


class Registrations:
    """What a running battle of one robot and its player has registered with the ROS master; the robot's ID is 0."""

    def __init__(self, port: int) -> None:
        self._master = Master(f"http://127.0.0.1:{port}", "/test")

    def registered(self, kind: int) -> set[tuple[str, str]]:
        """(topic or service, node): publishers for `kind` 0, subscribers for 1, services for 2."""
        return {(name, node) for name, node in self.all(kind) if not USUAL.fullmatch(name)}

    def all(self, kind: int) -> set[tuple[str, str]]:
        """The same, with what every ROS network has."""
        return {(name, node) for name, nodes in self._master.call("getSystemState")[kind] for node in nodes}

    def topic_types(self) -> dict[str, str]:
        types = self._master.call("getTopicTypes")
        return {name: kind for name, kind in types if not USUAL.fullmatch(name)}


@pytest.fixture(scope="module")
def master() -> Iterator[Registrations]:
    with Battle(robots=1) as battle, Player(battle, "Ann") as ann:
        assert ann.robot == 0
        yield Registrations(battle.ports["LASERBOT_ROS_PORT"])


def of_robot_0(name: str) -> str:
    return name.replace("<ID>", "0")


@pytest.mark.slow
def test_the_topics_are_those_of_a_battle(master: Registrations) -> None:
    rows = table(PAGE, "Topics")
    lasting = [row for row in rows if "while a client wants it" not in row["when"]]
    # some listen for a camera above the floor, which this battle does not have
    above = {row["topic"] for row in table(PAGE, "A camera above the floor")} - {row["topic"] for row in rows}
    publishers = {(of_robot_0(row["topic"]), of_robot_0(row["from"])) for row in rows}
    subscribers = {(of_robot_0(row["topic"]), of_robot_0(row["to"])) for row in lasting}

    def listening() -> set[tuple[str, str]]:
        return {(topic, node) for topic, node in master.registered(1) if topic not in above}

    until(lambda: master.registered(0) >= publishers and listening() >= subscribers, 10, "the page's topics")
    assert master.registered(0) == publishers
    assert listening() == subscribers
    types = {topic: kind for topic, kind in master.topic_types().items() if topic not in above}
    assert types == {of_robot_0(row["topic"]): row["type"] for row in rows}


@pytest.mark.slow
def test_the_services_are_those_of_a_battle(master: Registrations) -> None:
    rows = table(PAGE, "Services")
    registered = {(re.sub("^/rosapi/.+", "/rosapi/*", service), node) for service, node in master.registered(2)}
    assert registered == {(row["service"], row["of"]) for row in rows}
    assert {row["type"] for row in rows} == {AddNewRobot._type, "rosapi/*"}


@pytest.mark.slow
def test_log_lines_go_where_ros_tools_look_for_them(master: Registrations) -> None:
    until(lambda: ("/rosout", "/rosout") in master.all(1), 10, "somebody reads everybody's log lines")
    assert ("/rosout_agg", "/rosout") in master.all(0)


@pytest.mark.slow
def test_the_nodes_are_those_of_the_tables() -> None:
    nodes = {row["node"] for row in table(PAGE, "Nodes")}
    topics, services = table(PAGE, "Topics"), table(PAGE, "Services")
    assert nodes == {row["from"] for row in topics} | {row["to"] for row in topics} | {row["of"] for row in services}
