"""The announcer in real networks, heard by another machine."""

import contextlib
import json
import re
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from laser_bot_battle.names import MASTER_HOST, MASTER_HOST_ALIAS, VERSION
from tests.support.lan import Lan, Machine, avahi, needs_root, sees
from tests.support.polling import until

pytestmark = needs_root

NAMES = (MASTER_HOST, MASTER_HOST_ALIAS)
EARS = "tests.integration.discovery.ears"


class Announcer:
    """`python3 -m server.announcer` on a machine of the LAN."""

    def __init__(self, machine: Machine, arena: str = "hall", **variables: str) -> None:
        nothing = dict.fromkeys(("ROS_MASTER_URI", "LASERBOT_ALIVE_FILE"), "")
        self.program = machine.python("server.announcer", env={**nothing, "LASERBOT_ARENA": arena, **variables})

    @property
    def output(self) -> str:
        return self.program.output

    def holds(self, name: str) -> None:
        self.program.wait_for(f"{name} is this machine")

    def holds_its_names(self) -> None:
        for name in NAMES:
            self.holds(name)

    def leaves(self, name: str, other: str) -> None:
        self.program.wait_for(f"{name} is left to {other}")

    @property
    def arena(self) -> str:
        """What it is called now, "" if it is not announced yet."""
        return ["", *re.findall("arena '([^']*)' is announced", self.output)][-1]


@pytest.fixture
def announcer() -> Iterator[type[Announcer]]:
    """Announcers; all are ended, and none may have written a traceback."""
    started: list[Announcer] = []

    class Started(Announcer):
        def __init__(self, machine: Machine, arena: str = "hall", **variables: str) -> None:
            super().__init__(machine, arena, **variables)
            started.append(self)

    yield Started
    for each in started:
        each.program.kill()
        assert "Traceback" not in each.output, each.output


class Ears:
    """What a machine hears of arenas."""

    def __init__(self, machine: Machine) -> None:
        self.program = machine.python(EARS)
        self.program.wait_for("{}")

    @property
    def arenas(self) -> dict[str, dict[str, Any]]:
        """Their records by their names; none before it has said anything."""
        lines = self.program.output.rpartition("\n")[0].splitlines()
        arenas: dict[str, dict[str, Any]] = json.loads(lines[-1]) if lines else {}
        return arenas

    def hears(self, *arenas: str, seconds: float = 5) -> None:
        """Wait until these arenas are announced, and no others."""
        until(lambda: self.arenas.keys() == set(arenas), seconds, f"arenas {arenas}")

    def hears_it_at(self, *addresses: str, seconds: float = 5) -> None:
        """Wait until the only arena has these addresses."""

        def is_there() -> bool:
            return [arena["addresses"] for arena in self.arenas.values()] == [list(addresses)]

        until(is_there, seconds, f"the arena at {addresses}")


@pytest.fixture
def ears() -> Iterator[type[Ears]]:
    with contextlib.ExitStack() as stack:

        class Started(Ears):
            def __init__(self, machine: Machine) -> None:
                super().__init__(machine)
                stack.callback(self.program.kill)

        yield Started


def addresses_of(name: str, asker: Machine) -> list[str]:
    """Who answers for a host name."""
    program = asker.python(EARS, name)
    assert program.exit_code() == 0, program.output
    addresses: list[str] = json.loads(program.output)
    return addresses


def test_it_announces_the_arena_and_withdraws_it_at_its_end(lan: Lan, announcer, ears) -> None:
    master, robot = lan.machine(), lan.machine()
    heard = ears(robot)
    hall = announcer(master, LASERBOT_WEB_PORT="80", LASERBOT_ROSBRIDGE_PORT="91", ROS_MASTER_URI="http://localhost:92")
    heard.hears("hall")
    arena = heard.arenas["hall"]
    assert arena.pop("host").startswith("laserbot-")
    assert arena == {
        "addresses": ["10.9.0.1"],
        "port": 80,
        "text": {"version": VERSION, "rosbridge": "91", "ros": "92"},
    }
    hall.holds_its_names()
    assert hall.program.stop(signal.SIGTERM) == 0
    heard.hears(seconds=2)
    for name in NAMES:
        assert addresses_of(name, robot) == []


def test_it_can_be_ended_before_it_has_announced_anything(lan: Lan, announcer) -> None:
    hall = announcer(lan.machine(), LASERBOT_LOG_LEVEL="debug")
    hall.program.wait_for("Using selector")  # asyncio's first word
    assert hall.program.stop(signal.SIGINT) == 0


def test_it_shows_that_it_works(lan: Lan, announcer, tmp_path: Path) -> None:
    alive = tmp_path / "alive"
    announcer(lan.machine(), LASERBOT_ALIVE_FILE=str(alive))
    until(alive.exists, 5, "a sign of life")
    first = alive.stat().st_mtime
    until(lambda: alive.stat().st_mtime > first, 2, "another one")


@pytest.mark.slow
def test_after_a_crash_it_comes_back_by_the_same_name(lan: Lan, announcer, ears) -> None:
    master, robot = lan.machine(), lan.machine()
    heard = ears(robot)
    first = announcer(master)
    heard.hears("hall")
    first.program.kill()
    second = announcer(master)
    second.holds_its_names()
    assert second.arena == "hall"
    until(lambda: heard.arenas["hall"]["host"] in robot_sees(robot), 5, "the new one's records")
    heard.hears("hall")


def robot_sees(robot: Machine) -> str:
    """The records of all arenas, asked for anew."""
    program = robot.python(EARS)
    try:
        return program.wait_for("laserbot-")
    finally:
        program.kill()


def test_it_follows_a_change_of_address(lan: Lan, announcer, ears) -> None:
    master, robot = lan.machine(), lan.machine()
    heard = ears(robot)
    hall = announcer(master)
    hall.holds_its_names()
    heard.hears_it_at("10.9.0.1")
    master.set_address(7)
    until(lambda: "10.9.0.7" in heard.arenas["hall"]["addresses"], 2, "the new address")
    assert hall.arena == "hall"
    until(lambda: hall.output.count("is this machine") == 4, 10, "its names at the new address")
    ears(robot).hears_it_at("10.9.0.7")
    for name in NAMES:
        assert addresses_of(name, robot) == ["10.9.0.7"]


@pytest.mark.slow
def test_a_second_address_is_announced_and_leaves_again(lan: Lan, announcer, ears) -> None:
    master, robot = lan.machine(), lan.machine()
    heard = ears(robot)
    announcer(master)
    heard.hears_it_at("10.9.0.1")
    master.ip("addr", "add", "10.9.0.9/24", "dev", "eth0")
    until(lambda: set(heard.arenas.get("hall", {}).get("addresses", [])) == {"10.9.0.1", "10.9.0.9"}, 3, "both")
    master.ip("addr", "del", "10.9.0.9/24", "dev", "eth0")
    heard.hears_it_at("10.9.0.1", seconds=3)


@pytest.mark.slow
def test_without_a_network_it_waits_for_one(lan: Lan, announcer, ears) -> None:
    master, robot = lan.machine(), lan.machine()
    heard = ears(robot)
    master.ip("addr", "flush", "dev", "eth0", "scope", "global")
    hall = announcer(master)
    hall.program.wait_for("nothing is announced: LASERBOT_BIND=0.0.0.0 is no address in a network now")
    master.set_address(5)
    heard.hears_it_at("10.9.0.5")
    assert hall.output.count("nothing is announced") == 1


@pytest.mark.slow
def test_a_cut_with_the_address_kept_changes_nothing(lan: Lan, announcer, ears) -> None:
    master, robot = lan.machine(), lan.machine()
    hall = announcer(master)
    hall.holds_its_names()
    before = hall.output
    lan.plug(master, False)
    with pytest.raises(AssertionError):
        sees(robot, "10.9.0.1")  # 10 s
    lan.plug(master)
    ears(robot).hears_it_at("10.9.0.1")
    assert addresses_of(MASTER_HOST, robot) == ["10.9.0.1"]
    assert hall.output == before


@pytest.mark.parametrize("bind", ["127.0.0.1", "localhost"])
def test_a_game_for_this_machine_only_is_not_announced(lan: Lan, announcer, ears, bind: str) -> None:
    master, robot = lan.machine(), lan.machine()
    heard = ears(robot)
    hall = announcer(master, LASERBOT_BIND=bind)
    other = announcer(robot, "other")
    hall.program.wait_for(f"nothing is announced: LASERBOT_BIND={bind} is no address in a network now")
    other.holds_its_names()
    heard.hears("other")
    assert len(hall.output.splitlines()) == 1
    assert hall.program.stop(signal.SIGTERM) == 0


def test_only_the_address_on_which_the_game_listens_is_announced(lan: Lan, announcer, ears) -> None:
    master, robot = lan.machine(), lan.machine()
    master.ip("addr", "add", "10.9.0.9/24", "dev", "eth0")
    heard = ears(robot)
    announcer(master, LASERBOT_BIND="10.9.0.9").holds_its_names()
    heard.hears_it_at("10.9.0.9")
    assert addresses_of(MASTER_HOST, robot) == ["10.9.0.9"]


def test_with_ipv6_it_announces_ipv4_which_is_all_that_ros_knows(lan: Lan, announcer, ears) -> None:
    master, robot = lan.machine(), lan.machine()
    for number, machine in enumerate((master, robot), 1):
        machine.ip("addr", "add", f"fd00::{number}/64", "dev", "eth0", "nodad")
    heard = ears(robot)
    announcer(master).holds_its_names()
    heard.hears_it_at("10.9.0.1")
    assert addresses_of(MASTER_HOST, robot) == ["10.9.0.1"]


@pytest.mark.slow
def test_avahi_elsewhere_finds_the_arena_and_the_host_names(lan: Lan, announcer, tmp_path: Path) -> None:
    master, robot = lan.machine(), lan.machine()
    announcer(master).holds_its_names()
    with avahi(robot, tmp_path, "raspberrypi1"):
        for name in NAMES:
            assert robot.run("avahi-resolve", "-4", "-n", name).split() == [name, "10.9.0.1"]
        found = robot.run("avahi-browse", "-rptk", "_laserbot._tcp")
        assert f'10.9.0.1;5000;"ros=11311" "rosbridge=9090" "version={VERSION}"' in found
        assert "LaserBot\\032Battle\\032hall" in robot.run("avahi-browse", "-ptk", "_http._tcp")


@pytest.mark.slow
def test_a_host_name_of_avahi_on_the_same_machine_is_left_to_it(lan: Lan, announcer, ears, tmp_path: Path) -> None:
    master, robot = lan.machine(), lan.machine()
    heard = ears(robot)
    with avahi(master, tmp_path, "laser_bot_master") as daemon:
        hall = announcer(master)
        hall.leaves(MASTER_HOST, "10.9.0.1")
        hall.holds(MASTER_HOST_ALIAS)
        heard.hears_it_at("10.9.0.1")
        for name in NAMES:
            assert addresses_of(name, robot) == ["10.9.0.1"]
        assert hall.program.stop(signal.SIGTERM) == 0
        heard.hears()
        assert addresses_of(MASTER_HOST, robot) == ["10.9.0.1"], "avahi still answers"
        assert "conflict" not in daemon.output


@pytest.mark.slow
def test_avahi_that_starts_later_on_the_same_machine_keeps_its_name(lan: Lan, announcer, tmp_path: Path) -> None:
    master, robot = lan.machine(), lan.machine()
    hall = announcer(master)
    hall.holds_its_names()
    with avahi(master, tmp_path, "laser_bot_master") as daemon:
        assert "Host name is laser_bot_master.local" in daemon.output
        assert hall.program.stop(signal.SIGTERM) == 0
        assert addresses_of(MASTER_HOST, robot) == ["10.9.0.1"], "avahi answers"
        assert "conflict" not in daemon.output


@pytest.mark.slow
def test_a_name_is_taken_over_when_nobody_answers_for_it_any_more(lan: Lan, announcer, tmp_path: Path) -> None:
    master, robot = lan.machine(), lan.machine()
    with avahi(robot, tmp_path, "laser_bot_master"):
        hall = announcer(master)
        hall.leaves(MASTER_HOST, "10.9.0.2")
    until(lambda: f"{MASTER_HOST} is this machine" in hall.output, 40, "the name is taken over")
    assert addresses_of(MASTER_HOST, robot) == ["10.9.0.1"]
    assert hall.output.count(f"{MASTER_HOST} is left") == 1


def test_the_second_master_of_a_name_is_called_otherwise(lan: Lan, announcer, ears) -> None:
    first, second, robot = (lan.machine() for _ in range(3))
    heard = ears(robot)
    one = announcer(first)
    one.holds_its_names()
    two = announcer(second)
    two.program.wait_for("another master is called 'hall': this one is called 'hall-2'")
    for name in NAMES:
        two.leaves(name, "10.9.0.1")
        assert addresses_of(name, robot) == ["10.9.0.1"]
    heard.hears("hall", "hall-2")
    assert heard.arenas["hall"]["addresses"] == ["10.9.0.1"]
    assert heard.arenas["hall-2"]["addresses"] == ["10.9.0.2"]
    assert "left" not in one.output


@pytest.mark.slow
def test_two_masters_that_start_at_once_share_no_name(lan: Lan, announcer, ears) -> None:
    first, second, robot = (lan.machine() for _ in range(3))
    heard = ears(robot)
    one, two = announcer(first), announcer(second)
    heard.hears("hall", "hall-2", seconds=10)
    two.holds_its_names()
    for name in NAMES:
        one.leaves(name, "10.9.0.2")
        until(lambda name=name: addresses_of(name, robot) == ["10.9.0.2"], 10, "the higher address keeps it")


@pytest.mark.slow
def test_when_two_networks_become_one_the_higher_address_keeps_the_names(lan: Lan, announcer, ears) -> None:
    first, second, robot = (lan.machine() for _ in range(3))
    lan.plug(second, False)
    one, two = announcer(first), announcer(second)
    for each in (one, two):
        each.holds_its_names()
        assert each.arena == "hall"
    heard = ears(robot)
    heard.hears_it_at("10.9.0.1")
    lan.plug(second)
    sees(robot, "10.9.0.2")
    for name in NAMES:
        until(lambda asked=name: addresses_of(asked, robot) == ["10.9.0.2"], 10, "one machine answers")
        one.leaves(name, "10.9.0.2")
    ears(robot).hears("hall", "hall-2", seconds=10)


@pytest.mark.slow
def test_a_flood_of_nonsense_costs_no_memory_and_the_arena_stays_announced(lan: Lan, announcer, ears) -> None:
    master, robot, other = (lan.machine() for _ in range(3))
    hall = announcer(master)
    hall.holds_its_names()
    process = psutil.Process(hall.program.process.pid)
    memory, said = process.memory_info().rss, len(hall.output.splitlines())
    flood = other.python("tests.integration.discovery.flood", "10000")
    flood.wait_for("done", 120)
    assert flood.exit_code() == 0
    assert addresses_of(MASTER_HOST, robot) == ["10.9.0.1"]
    ears(robot).hears_it_at("10.9.0.1")
    assert process.memory_info().rss < memory + 15_000_000
    assert len(hall.output.splitlines()) <= said + 1
    assert hall.program.stop(signal.SIGTERM) == 0
