"""A robot keeps to its master while that lives, and follows it to another address."""

import time
from pathlib import Path

import pytest

from tests.integration.discovery.master import LanMaster, announced
from tests.integration.discovery.robot import LanRobot, stays
from tests.support.lan import Lan, needs_root
from tests.support.polling import until

pytestmark = needs_root


def joined(master: LanMaster, robot: LanRobot) -> None:
    """Return when the robot is in the arena, and can move."""
    master.has_robot()
    robot.wait_for("/Robot0/command")


@pytest.mark.slow
def test_no_announcement_takes_it_away_from_a_master_that_lives(lan: Lan, tmp_path: Path) -> None:
    home, elsewhere = lan.machine(), lan.machine()
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(lan.machine(), tmp_path) as robot:
        joined(master, robot)
        twin = announced(elsewhere, "hall", "10.9.0.2")
        with LanMaster(elsewhere, "attic", tmp_path) as attic:  # at the address that the false one names
            stays(lambda: (master.robots(), attic.robots()) == (1, 0), 5)
        twin.kill()
        assert robot.lives() == 1
        assert "looking for arena" not in robot.output


@pytest.mark.slow
def test_its_web_server_alone_being_away_is_no_reason_to_leave(lan: Lan, tmp_path: Path) -> None:
    home, elsewhere = lan.machine(), lan.machine()
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(lan.machine(), tmp_path) as robot:
        joined(master, robot)
        with LanMaster(elsewhere, "attic", tmp_path) as attic:
            twin = announced(elsewhere, "hall", "10.9.0.2")
            master.server.kill()
            robot.wait_for("looking for arena 'hall' at another address")
            stays(lambda: attic.robots() == 0, 3)
            twin.kill()
            master.start_server()
            joined(master, robot)
        assert "it was at" not in robot.output


def test_a_master_that_changes_its_address_is_found_within_5_s(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path) as robot:
        joined(master, robot)
        changed = time.monotonic()
        home.set_address(7)
        until(lambda: master.server.output.count("serving") == 2, what="the server at its new address")
        came_up = time.monotonic()
        until(lambda: robot.output.count("New robot ID = 0") == 2, 5, "registered there")
        registered = time.monotonic()
        print(f"came up after {came_up - changed:.1f} s, registered {registered - came_up:.1f} s later")
        robot.wait_for("arena 'hall' at 10.9.0.7, announced; it was at 10.9.0.1")
        until(lambda: robot.lives() == 2)
        master.has_robot()


@pytest.mark.slow
def test_a_robot_that_changes_its_address_tells_ros(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path) as robot:
        joined(master, robot)
        away.set_address(8)
        robot.wait_for("ROS was told the address 10.9.0.2, and this robot now has 10.9.0.8: registering again")
        until(lambda: master.node("/Robot0").startswith("http://10.9.0.8:"), what="ROS knows the new address")
        master.has_robot()


@pytest.mark.slow
def test_a_master_that_was_away_and_comes_back_at_another_address_is_found_within_5_s(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path) as robot:
        joined(master, robot)
        master.kill()
        robot.wait_for("is gone", 60)  # the serial node ends, and so this life of the robot
        robot.wait_for("no arena 'hall' announces itself")
        home.set_address(7)
        master.start()
        came_up = time.monotonic()
        until(lambda: robot.output.count("New robot ID = 0") == 2, 5, "registered there")
        print(f"registered {time.monotonic() - came_up:.1f} s after it came up")
        master.has_robot()


@pytest.mark.slow
def test_a_cut_of_10_s_and_a_false_announcement_meanwhile_change_nothing(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path) as robot:
        joined(master, robot)
        lan.plug(away, False)
        liar = announced(lan.machine(), "hall", "10.9.0.99", "--web", "1")
        robot.wait_for("looking for arena 'hall' at another address")
        until(lambda: master.robots() == 0, what="the server misses the robot")
        cut = time.monotonic()
        until(lambda: time.monotonic() > cut + 8)
        lan.plug(away)
        master.has_robot()
        assert "it was at" not in robot.output
        liar.kill()


@pytest.mark.slow
def test_a_cut_of_10_s_and_a_twin_that_answers_change_nothing(lan: Lan, tmp_path: Path) -> None:
    home, away, elsewhere = lan.machine(), lan.machine(), lan.machine()
    with (
        LanMaster(home, "hall", tmp_path) as master,
        LanMaster(elsewhere, "attic", tmp_path) as attic,
        LanRobot(away, tmp_path, LASERBOT_ARENA="hall") as robot,
    ):
        joined(master, robot)
        lan.plug(away, False)
        twin = announced(elsewhere, "hall", "10.9.0.3")
        robot.wait_for("looking for arena 'hall' at another address")
        cut = time.monotonic()
        until(lambda: time.monotonic() > cut + 8)
        lan.plug(away)
        master.has_robot()
        stays(lambda: attic.robots() == 0, 3)
        assert "it was at" not in robot.output
        twin.kill()


@pytest.mark.slow
def test_the_arena_that_it_joined_without_a_name_stays_its_own(lan: Lan, tmp_path: Path) -> None:
    home, elsewhere = lan.machine(), lan.machine()
    with (
        LanMaster(elsewhere, "attic", tmp_path) as attic,
        LanMaster(home, "hall", tmp_path) as master,
        LanRobot(lan.machine(), tmp_path) as robot,
    ):
        robot.wait_for("there are several arenas")
        attic.kill()
        joined(master, robot)
        master.kill()
        attic.start()
        robot.wait_for("no arena 'hall' announces itself in this network; there is 'attic'", 60)
        master.start()
        master.has_robot()
        assert attic.robots() == 0


@pytest.mark.slow
def test_nonsense_while_it_looks_for_its_master_costs_no_memory_and_hides_nothing(lan: Lan, tmp_path: Path) -> None:
    home, liar = lan.machine(), lan.machine()
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(lan.machine(), tmp_path) as robot:
        joined(master, robot)
        lan.plug(home, False)
        robot.wait_for("looking for arena 'hall' at another address")
        before, lines = robot.memory(), robot.output.count("\n")
        for _ in range(3):
            announced(liar, "--nonsense", "10000").kill()
        assert robot.memory() < before + 60, "MB"
        assert robot.output.count("\n") < lines + 10
        home.set_address(7)
        lan.plug(home)
        robot.wait_for("arena 'hall' at 10.9.0.7, announced; it was at 10.9.0.1")
        master.has_robot()
