"""`python -m robot.find`: what people see who look for a master."""

import re
import signal
from pathlib import Path

import pytest

from laser_bot_battle.search import LISTEN
from tests.integration.discovery.master import LanMaster, announced
from tests.support.lan import Lan, Machine, needs_root
from tests.support.programs import ROOT, Program

pytestmark = needs_root

# announced, and what is said of it
USELESS = {
    ("foreign", "10.9.0.9", "--version", "2.0.0"): "passed over: 'foreign', because it is of version 2.0.0",
    ("unversioned", "10.9.0.9", "--version", ""): "passed over: 'unversioned', because its version is missing",
    ("portless", "10.9.0.9", "--web", "0"): "passed over: 'portless', because its web port is not a port",
    ("rosless", "10.9.0.9", "--ros", ""): "passed over: 'rosless', because its ros is missing",
    ("bridgeless", "10.9.0.9", "--rosbridge", "70000"): "because its rosbridge port is not a port",
    ("nowhere",): "passed over: 'nowhere', because it does not say where it is",
    ("inward", "127.0.0.1"): "passed over: 'inward', because it names no address",
    ("\x1b[2Jcoded", "10.9.0.9"): r"passed over: '\x1b[2Jcoded', because its name is not one of an arena",
    ("<b>dead</b>", "10.9.0.9"): "arena '<b>dead</b>', version 1.0.0\n  10.9.0.9         no ROS master answers\n",
}


def find(machine: Machine, *options: str) -> Program:
    return machine.python("robot.find", *options)


def test_it_lists_an_arena_and_says_which_of_its_addresses_answers(lan: Lan, tmp_path: Path) -> None:
    with LanMaster(lan.machine(), "hall", tmp_path):
        program = find(lan.machine())
        assert program.exit_code(30) == 0
    assert program.output == (
        "Listening for 3 s ...\n"
        "arena 'hall', version 1.0.0\n"
        "  10.9.0.1         its ROS master answers\n"
        "  ports: web 5000, rosbridge 9090, ROS 11311\n"
    )


@pytest.mark.slow
def test_every_search_beside_the_announcer_and_each_other_hears_the_arena(lan: Lan, tmp_path: Path) -> None:
    """They share port 5353, and an answer to one may go to another."""
    home = lan.machine()
    with LanMaster(home, "hall", tmp_path):
        searches = [home.python("robot.find", "--seconds", str(LISTEN)) for _ in range(4)]
        assert [program.exit_code(30) for program in searches] == [0] * 4, [one.output for one in searches]


@pytest.mark.slow
def test_it_says_what_was_passed_over_and_why_and_what_to_check(lan: Lan) -> None:
    liar, away = lan.machine(), lan.machine()
    liars = [announced(liar, *words) for words in USELESS]
    program = find(away)
    assert program.exit_code(30) == 1
    for words, said in USELESS.items():
        assert said in program.output, (words, program.output)
    assert "Do the firewalls let UDP port 5353 pass" in program.output
    for program in liars:
        program.kill()


def test_it_says_so_without_any_network(lan: Lan) -> None:
    machine = lan.machine()
    machine.ip("addr", "flush", "dev", "eth0")
    program = find(machine)
    assert program.exit_code(30) == 1
    assert "Nothing can be heard here: this machine has no address in any network." in program.output


def test_ctrl_c_ends_it_at_once_and_quietly(lan: Lan) -> None:
    program = find(lan.machine(), "--seconds", "600")
    program.wait_for("Listening for 600 s ...")
    assert program.stop(signal.SIGINT) == 130
    assert program.output == "Listening for 600 s ...\n"


@pytest.mark.slow
def test_a_flood_of_nonsense_ends_it(lan: Lan) -> None:
    program = find(lan.machine(), "--seconds", "600")
    program.wait_for("Listening")
    liar = announced(lan.machine(), "--nonsense", "10000")
    assert program.exit_code(60) == 1
    assert "passed over: everything beyond 64 arenas" in program.output
    liar.kill()


def test_an_impossible_time_is_refused(lan: Lan) -> None:
    program = find(lan.machine(), "--seconds", "nan")
    assert program.exit_code(30) == 2
    assert "'nan' is not a number of seconds up to 3600" in program.output


def test_it_needs_neither_ros_nor_what_is_generated(lan: Lan, tmp_path: Path) -> None:
    (tmp_path / "rospy.py").write_text("raise ImportError('no ROS here')\n")
    path = f"{tmp_path}:{ROOT}:{ROOT}/laser_bot_battle/src"
    program = lan.machine().python("robot.find", "--help", env={"PYTHONPATH": path})
    assert program.exit_code(30) == 0, program.output
    assert re.search(r"--seconds SECONDS\s+how long to listen \(default 3\)", program.output)
