"""The address by which ROS finds the master's programs, in a real network, with a real ROS master."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.lan import Lan, Machine, needs_root, sees
from tests.support.polling import until
from tests.support.programs import ROOT, Program

pytestmark = needs_root

NODES = {"server.main": "/robots_server", "server.rosbridge": "/rosbridge_websocket"}
READY = {"server.main": "serving the game", "server.rosbridge": "listening on"}
MASTER = "http://127.0.0.1:11311"
every_program = pytest.mark.parametrize("module", NODES)


class Master:
    """A machine with a ROS master."""

    def __init__(self, machine: Machine, folder: Path) -> None:
        self.machine = machine
        self._folder = folder
        self._started = [self._python("-m", "server.ros.master", "-p", "11311")]
        until(self._listens, 10, "the ROS master")

    def start(self, module: str, on: Machine | None = None, **variables: str) -> Program:
        """A program of the master on this machine or another."""
        self._started.append(self._python("-m", module, on=on, **variables))
        return self._started[-1]

    def finds(self, program: Program, at: str, times: int = 1) -> None:
        """Wait until ROS finds the program, which must be at that address; when it has begun `times`."""
        module = program.command[-1]
        until(lambda: program.output.count(READY[module]) >= times, 30, READY[module])
        code = f"from xmlrpc.client import *; print(ServerProxy({MASTER!r}).lookupNode('/test', {NODES[module]!r}))"
        assert f"'http://{at}:" in self.machine.run(sys.executable, "-c", code)

    def end(self) -> None:
        for program in reversed(self._started):
            program.kill()

    def _python(self, *words: str, on: Machine | None = None, **variables: str) -> Program:
        env = {
            "PYTHONPATH": f"{ROOT}:{ROOT / 'build/python'}",
            "ROS_MASTER_URI": "http://localhost:11311",
            "ROS_IP": "",
            "ROS_HOSTNAME": "",
            "ROS_HOME": str(self._folder),
            "ROS_LOG_DIR": str(self._folder),
            "LASERBOT_DATA": str(self._folder),
            **variables,
        }
        return (on or self.machine).program(sys.executable, *words, env=env)

    def _listens(self) -> bool:
        return "11311" in self.machine.run("ss", "-ltn")


@pytest.fixture
def master(lan: Lan, tmp_path: Path) -> Iterator[Master]:
    master = Master(lan.machine(), tmp_path)
    yield master
    master.end()


@every_program
def test_robots_find_it_at_this_machines_address(master: Master, module: str) -> None:
    program = master.start(module)
    master.finds(program, "10.9.0.1")


@every_program
def test_it_is_found_where_it_listens(master: Master, module: str) -> None:
    master.machine.ip("addr", "add", "10.9.0.9/24", "dev", "eth0")
    master.finds(master.start(module, LASERBOT_BIND="10.9.0.9"), "10.9.0.9")


@every_program
def test_a_program_for_this_machine_only_is_found_on_it(master: Master, module: str) -> None:
    master.finds(master.start(module, LASERBOT_BIND="127.0.0.1"), "127.0.0.1")


@pytest.mark.parametrize("variable", ["ROS_IP", "ROS_HOSTNAME"])
@every_program
def test_an_address_that_is_set_is_kept(master: Master, module: str, variable: str) -> None:
    program = master.start(module, None, **{variable: "127.0.0.3"})
    master.finds(program, "127.0.0.3")
    assert "ROS finds" not in program.output


@every_program
def test_beside_another_machines_ros_master_it_is_found_at_its_own_address(
    lan: Lan, master: Master, module: str
) -> None:
    other = lan.machine()
    master.finds(master.start(module, on=other, ROS_MASTER_URI="http://10.9.0.1:11311"), "10.9.0.2")


@pytest.mark.slow
@every_program
def test_with_another_address_it_begins_anew_there(master: Master, module: str) -> None:
    program = master.start(module)
    master.finds(program, "10.9.0.1")
    master.machine.set_address(7)
    master.finds(program, "10.9.0.7", times=2)
    assert "ROS was told the address 10.9.0.1, and this machine now has 10.9.0.7" in program.output
    assert "Traceback" not in program.output


@pytest.mark.slow
@every_program
def test_a_program_that_was_there_before_the_network_is_found_in_it(master: Master, module: str) -> None:
    master.machine.ip("addr", "flush", "dev", "eth0", "scope", "global")
    program = master.start(module)
    master.finds(program, "127.0.0.1")
    master.machine.set_address(7)
    master.finds(program, "10.9.0.7", times=2)


@pytest.mark.slow
def test_a_cut_of_10_s_with_the_address_kept_changes_nothing(lan: Lan, master: Master) -> None:
    programs = [master.start(module) for module in NODES]
    for program in programs:
        master.finds(program, "10.9.0.1")
    before = [program.output for program in programs]
    other = lan.machine()
    lan.plug(master.machine, False)
    with pytest.raises(AssertionError):
        sees(other, "10.9.0.1")  # for 10 s
    lan.plug(master.machine)
    sees(other, "10.9.0.1")
    assert all(program.running for program in programs)
    assert [program.output for program in programs] == before
