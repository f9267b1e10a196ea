"""Which arena a robot joins that was told no address."""

import signal
from pathlib import Path

import pytest

from tests.integration.discovery.master import NOTHING_GIVEN, LanMaster, announced
from tests.integration.discovery.robot import LanRobot, stays
from tests.support.lan import Lan, avahi, needs_root
from tests.support.programs import ROOT

pytestmark = needs_root


def test_a_robot_joins_the_only_arena_without_any_address(lan: Lan, tmp_path: Path) -> None:
    with LanMaster(lan.machine(), "hall", tmp_path) as master, LanRobot(lan.machine(), tmp_path) as robot:
        master.has_robot()
        robot.wait_for("arena 'hall' at 10.9.0.1, announced")
        robot.wait_for("/Robot0/command")
    assert robot.output.count("announced") == 1


@pytest.mark.slow
def test_the_serial_node_finds_the_arena_when_it_is_started_by_hand(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    with LanMaster(home, "hall", tmp_path):
        device = tmp_path / "ttyACM0"
        firmware = ROOT / "build/firmware/laserbot.elf"
        uno = away.program(
            ROOT / "build/sim/avr_robot", "--firmware", firmware, "--name", "virtual0", "--serial", device
        )
        uno.wait_for("UART at")
        node = away.python("robot.serial_node", str(device), "__name:=Robot0", env=NOTHING_GIVEN)
        node.wait_for("arena 'hall' at 10.9.0.1, announced")
        node.wait_for("/Robot0 serves")
        assert node.stop() == 0
        uno.kill()
    lonely = away.python("robot.serial_node", str(device), env=NOTHING_GIVEN)
    assert lonely.exit_code(30) == 1
    assert "no arena announces itself in this network" in lonely.output


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("variables", [{}, {"LASERBOT_RETRY": "60"}], ids=["searching", "resting"])
def test_a_signal_ends_it_while_it_finds_nothing(
    lan: Lan, tmp_path: Path, number: signal.Signals, variables: dict[str, str]
) -> None:
    with LanRobot(lan.machine(), tmp_path, **variables) as robot:
        robot.wait_for("again in 0.2 s" if variables else "Starting service client")
        if number == signal.SIGTERM:  # whoever is impatient sends more than one
            robot.program.process.send_signal(number)
        assert robot.program.stop(number, seconds=3) == 0


def test_with_two_arenas_and_no_name_it_joins_none_and_says_which_there_are(lan: Lan, tmp_path: Path) -> None:
    with (
        LanMaster(lan.machine(), "hall", tmp_path) as hall,
        LanMaster(lan.machine(), "attic", tmp_path) as attic,
        LanRobot(lan.machine(), tmp_path, LASERBOT_RETRY="0.5") as robot,
    ):
        robot.wait_for("there are several arenas, 'attic', 'hall': choose one with LASERBOT_ARENA (again in 0.5 s)")
        stays(lambda: hall.robots() + attic.robots() == 0, 3)


@pytest.mark.slow
def test_with_a_name_it_joins_that_one(lan: Lan, tmp_path: Path) -> None:
    with (
        LanMaster(lan.machine(), "hall", tmp_path) as hall,
        LanMaster(lan.machine(), "attic", tmp_path) as attic,
        LanRobot(lan.machine(), tmp_path, LASERBOT_ARENA="Attic") as robot,
    ):
        attic.has_robot()
        robot.wait_for("arena 'attic' at 10.9.0.2, announced")
        assert hall.robots() == 0


def test_a_given_address_is_taken_and_nothing_looked_for(lan: Lan, tmp_path: Path) -> None:
    with LanMaster(lan.machine(), "hall", tmp_path) as hall, LanMaster(lan.machine(), "attic", tmp_path):
        with LanRobot(lan.machine(), tmp_path, LASERBOT_MASTER="10.9.0.1") as robot:
            hall.has_robot()
        assert "master at 10.9.0.1, as LASERBOT_MASTER says" in robot.output


@pytest.mark.slow
def test_ipv6_and_avahi_on_its_machine_do_not_disturb(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    for number, machine in enumerate((home, away), 1):
        machine.ip("addr", "add", f"fd00:9::{number}/64", "dev", "eth0", "nodad")
    with avahi(away, tmp_path, "robot"), LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path):
        master.has_robot()


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["bad", "10.9.0.9", "--version", "2.0.0"], "(passed over: 'bad', because it is of version 2.0.0"),
        (["bad", "10.9.0.9"], "arena 'bad' is announced at 10.9.0.9, but no ROS master answers there"),
    ],
)
def test_an_announcement_that_is_no_good_is_told_in_a_line_and_not_joined(
    lan: Lan, tmp_path: Path, words: list[str], reason: str
) -> None:
    liar = announced(lan.machine(), *words)
    with LanRobot(lan.machine(), tmp_path, LASERBOT_RETRY="0.5") as robot:
        robot.wait_for(reason)
        robot.wait_for("(again in 0.5 s)")
    liar.kill()
    assert "asking the Arduino" not in robot.output


@pytest.mark.slow
def test_a_false_place_under_the_same_name_does_not_hide_the_true_one(lan: Lan, tmp_path: Path) -> None:
    with LanMaster(lan.machine(), "hall", tmp_path) as master:
        liar = announced(lan.machine(), "hall", "10.9.0.99", "--web", "1")
        with LanRobot(lan.machine(), tmp_path, LASERBOT_ARENA="hall"):
            master.has_robot()
        liar.kill()


@pytest.mark.slow
def test_among_10000_announcements_of_nonsense_and_broken_packets_the_named_arena_is_joined(
    lan: Lan, tmp_path: Path
) -> None:
    home, away, liar = lan.machine(), lan.machine(), lan.machine()
    with LanRobot(away, tmp_path, LASERBOT_ARENA="hall") as robot:
        robot.wait_for("no arena 'hall' announces itself")
        before = robot.memory()
        announced(liar, "--nonsense", "10000").kill()
        robot.wait_for("(passed over: 'nonsense")
        lines = robot.output.count("\n")
        nonsense = liar.python("tests.support.announcing", "--nonsense", "10000")
        with LanMaster(home, "hall", tmp_path) as master:
            master.has_robot()
        nonsense.kill()
        assert robot.memory() < before + 40, "MB"
        assert robot.output.count("\n") < lines + 20


@pytest.mark.slow
def test_where_multicast_does_not_pass_it_says_what_to_set(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    lan.stop_multicast()
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path, LASERBOT_RETRY="0.5") as robot:
        robot.wait_for("no arena announces itself in this network: start it, or set LASERBOT_MASTER to its address")
        assert master.robots() == 0


@pytest.mark.slow
def test_where_multicast_does_not_pass_a_name_server_that_knows_the_usual_name_helps(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    lan.stop_multicast()
    hosts = tmp_path / "hosts"
    hosts.write_text("127.0.0.1 localhost\n10.9.0.1 laser_bot_master.local\n")
    away.run("mount", "--bind", hosts, "/etc/hosts")
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path) as robot:
        master.has_robot()
        robot.wait_for("master at laser_bot_master.local, by its usual host name, because no arena announces itself")


@pytest.mark.slow
def test_without_a_network_it_says_so_and_goes_on_when_there_is_one(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    away.ip("addr", "flush", "dev", "eth0")
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path, LASERBOT_RETRY="0.5") as robot:
        robot.wait_for("no arena can be heard here: this machine has no address in any network")
        away.set_address(2)
        master.has_robot()
