"""What goes wrong in an evening: programs end or stand still, connections are cut, the network loses packets."""

import contextlib
import os
import random
import shutil
import signal
import subprocess
from collections.abc import Callable
from typing import NamedTuple

from tests.soak.vitals import parts
from tests.support.battle import Battle

SECONDS = (0.5, 6.0)  # that a fault lasts
LOSS = 20  # % of the packets of a slow network
RESET = 0.5  # s in which each packet of a connection ends it
SPARED = "roslaunch"  # it starts all others again


class Fault(NamedTuple):
    text: str
    seconds: float  # until it is to be mended
    mend: Callable[[], None]


class Faults:
    """Chosen by `chance`. Those of the network need root, nft, and a network of its own around all of this."""

    def __init__(self, battle: Battle, chance: random.Random) -> None:
        self._battle, self._chance = battle, chance
        self.network = os.geteuid() == 0 and shutil.which("nft") is not None
        ports = ("LASERBOT_WEB_PORT", "LASERBOT_ROSBRIDGE_PORT", "LASERBOT_ROS_PORT")
        self._ports = [battle.ports[port] for port in ports]

    def next(self, kills: bool) -> Fault:
        """Do the next one; with `kills`, it may be that a program ends."""
        kinds = [self._freeze] + [self._kill] * kills + [self._cut, self._slow] * self.network
        return self._chance.choice(kinds)()

    def _part(self) -> tuple[str, int]:
        """Name and process of one part."""
        found = parts(self._battle)
        name = self._chance.choice(sorted(found.keys() - {SPARED}))
        return name, self._chance.choice(sorted(process.pid for process in found[name]))

    def _kill(self) -> Fault:
        name, pid = self._part()
        _signal(pid, signal.SIGKILL)
        return Fault(f"{name} killed", 0.0, lambda: None)

    def _freeze(self) -> Fault:
        name, pid = self._part()
        seconds = self._chance.uniform(*SECONDS)
        _signal(pid, signal.SIGSTOP)
        return Fault(f"{name} frozen for {seconds:.1f} s", seconds, lambda: _signal(pid, signal.SIGCONT))

    def _cut(self) -> Fault:
        port = self._chance.choice(self._ports)
        _filter(port, "reject with tcp reset")
        return Fault(f"connections to port {port} cut", RESET, _no_filter)

    def _slow(self) -> Fault:
        port, seconds = self._chance.choice(self._ports), self._chance.uniform(*SECONDS)
        _filter(port, f"numgen random mod 100 < {LOSS} drop")
        return Fault(f"{LOSS} % loss at port {port} for {seconds:.1f} s", seconds, _no_filter)


def _signal(pid: int, number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError):  # it has just ended
        os.kill(pid, number)


def _filter(port: int, what: str) -> None:
    ends = ("tcp dport", "tcp sport")
    rules = [f"add rule inet soak input {end} {port} {what}" for end in ends]
    chain = "add chain inet soak input { type filter hook input priority 0; }"
    _nft("\n".join(["add table inet soak", chain, *rules]))


def _no_filter() -> None:
    _nft("delete table inet soak")


def _nft(rules: str) -> None:
    subprocess.run(["nft", "-f", "-"], input=rules, text=True, check=True)
