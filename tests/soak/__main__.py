"""A long evening: `python3 -m tests.soak` plays battle after battle while parts fail at random.

There are bots, light robots, and people who come, wait and go. In the second half nothing is killed: there, the memory
of each program must be flat. At the end, all must be as it was before the people came, and each result must be what its
events lead to.
"""

import argparse
import contextlib
import os
import random
import re
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from sqlalchemy import URL

from tests.soak import records, vitals
from tests.soak.faults import Fault, Faults
from tests.soak.people import People
from tests.support.battle import Battle
from tests.support.leaks import adopt_orphans, nothing_left
from tests.support.light_robots import LightRobots
from tests.support.player import players_and_free_robots
from tests.support.polling import competitors, until
from tests.support.programs import ROOT

MINUTES = 30.0
ROBOTS = 2  # with the real firmware, each with a bot
LIGHT = 4  # robots
PEOPLE = 7  # for the light robots: some wait
HITS = 2  # a second, of light robots
BETWEEN_FAULTS = (4.0, 12.0)  # s
SAMPLE = 2.0  # s between two looks at the memory
RECOVERY = 90.0  # s until all is as it was
LOG = ROOT / "build" / "soak.log"  # of all programs
RULES = {
    "LASERBOT_LIGHT": "plain",  # that of the light robots
    "LASERBOT_COUNTDOWN": "2",
    "LASERBOT_BATTLE_LIMIT": "20",
    "LASERBOT_PLAYER_TIMEOUT": "5",
    "LASERBOT_SEAT_TIMEOUT": "5",
    "LASERBOT_OFFER": "5",
    "LASERBOT_IDLE": "10",
    "LASERBOT_BATTLES_IN_ROW": "2",
}


class Evening:
    """A battle that is ready, with its light robots; `faults` counts what has happened."""

    def __init__(self, battle: Battle, seed: int) -> None:
        self._battle, self._seed = battle, seed
        self._faults = Faults(battle, random.Random(seed))
        self._chance = random.Random(f"{seed} pauses")
        self.memory = vitals.Memory(battle)
        self.happened = 0
        self.database = URL.create("sqlite", database=str(battle.folder / "data" / "laserbot.db"))
        self.before = vitals.count(battle)
        self.graph = vitals.graph(battle)
        if not self._faults.network:
            print("Without root and nft, the network does not fail.")

    def pass_by(self, minutes: float) -> None:
        """People play, and parts fail."""
        began = time.monotonic()
        middle, end = began + 30 * minutes, began + 60 * minutes
        told, sampled, due = began, began, began + self._chance.uniform(*BETWEEN_FAULTS)
        fault: Fault | None = None
        total = self.memory.look()
        people = People(PEOPLE, self._battle, self._seed)
        try:
            while (now := time.monotonic()) < end:
                if now >= due:
                    fault, due = self._go_wrong(fault, now < middle)
                if now >= sampled + SAMPLE:
                    sampled = now
                    total = self.memory.look()
                    if now < middle:
                        self.memory.forget()
                if now >= told + 60:
                    told = now
                    self._tell((now - began) / 60, total)
                time.sleep(0.1)
        finally:
            if fault:
                fault.mend()
            people.close()

    def _go_wrong(self, fault: Fault | None, kills: bool) -> tuple[Fault | None, float]:
        """Mend the fault that there is, or have the next one; and when to do that again."""
        now = time.monotonic()
        if fault:
            fault.mend()
            return None, now + self._chance.uniform(*BETWEEN_FAULTS)
        fault = self._faults.next(kills)
        self.happened += 1
        print(f"  {fault.text}", flush=True)
        return fault, now + fault.seconds

    def _tell(self, minute: float, memory: float) -> None:
        there = players_and_free_robots(self._battle)
        who = f"{len(there[0])} players, {there[1]} robots free" if there else "the server does not answer"
        print(
            f"minute {minute:.0f}: {records.battles(self.database)} battles, {self.happened} faults, {who}, "
            f"{memory:.0f} MiB",
            flush=True,
        )

    # the verdict

    def checks(self) -> dict[str, Callable[[], list[str]]]:
        """By what must be true, what asks for the reasons why it is not."""
        return {
            "all robots and nobody but the bots are there": lambda: settled(lambda: absent(self._battle)),
            "no process, thread or descriptor is left over": lambda: settled(self._leaks),
            "no publisher, subscriber or service is left over": lambda: settled(self._graph_changes),
            "no row of the database is left over": lambda: settled(lambda: records.left_over(self.database)),
            "each result is what its events lead to": self._results,
            f"memory grows by less than {vitals.GROWTH} MiB a minute": self._growth,
            "no program has failed in its own code": self._tracebacks,
        }

    def _leaks(self) -> list[str]:
        return vitals.leaks(self.before, vitals.count(self._battle))

    def _graph_changes(self) -> list[str]:
        now = vitals.graph(self._battle)
        return [f"new: {entry}" for entry in sorted(now - self.graph)] + [
            f"gone: {entry}" for entry in sorted(self.graph - now)
        ]

    def _results(self) -> list[str]:
        return records.wrong_results(self.database) if records.battles(self.database) else ["no battle has ended"]

    def _growth(self) -> list[str]:
        growth = self.memory.growth()
        for name, slope in sorted(growth.items()):
            print(f"  {name}: {slope:+.3f} MiB a minute")
        if not growth:
            print(f"  no program was watched for {vitals.WATCHED:.0f} s: the evening was too short to tell")
        return [f"{name} grows by {slope:.2f} MiB a minute" for name, slope in growth.items() if slope > vitals.GROWTH]

    def _tracebacks(self) -> list[str]:
        errors = Counter(re.findall(r"^Traceback .*\n(?:[ \t].*\n)*(.*)", self._battle.log, re.MULTILINE))
        return [f"{count} times {error}" for error, count in errors.most_common()]


def absent(battle: Battle) -> list[str]:
    """Why it is not so that the bots play and the light robots are free; nothing if it is."""
    there = players_and_free_robots(battle)
    if there is None:
        return ["the server does not answer"]
    names = sorted(name for name, _ in there[0])
    bots = [f"Bot{number}" for number in range(1, ROBOTS + 1)]
    return [f"{names} play, {there[1]} robots are free"] if (names, there[1]) != (bots, LIGHT) else []


def settled(reasons: Callable[[], list[str]]) -> list[str]:
    """The reasons that remain when all had time."""
    with contextlib.suppress(AssertionError):
        until(lambda: not reasons(), RECOVERY)
    return reasons()


def main() -> int:
    parser = argparse.ArgumentParser(description="A long evening, in which parts fail at random.")
    parser.add_argument("--minutes", type=float, default=MINUTES)
    parser.add_argument("--seed", type=int, help="the same one makes the same faults (default: another one each time)")
    arguments = parser.parse_args()
    seed = random.randrange(10**6) if arguments.seed is None else arguments.seed
    print(f"{arguments.minutes:g} minutes, SEED={seed}", flush=True)
    # a shell starts background programs with SIGINT ignored, and so would be what is started and stopped by SIGINT here
    signal.signal(signal.SIGINT, signal.default_int_handler)
    adopt_orphans()
    verdicts: dict[str, list[str]] = {}
    with tempfile.TemporaryDirectory(prefix="laserbot-soak-") as folder:
        os.environ["TMPDIR"] = tempfile.tempdir = folder
        try:
            with nothing_left(Path(folder)):
                verdicts.update(soak(arguments.minutes, seed))
        except AssertionError as error:
            verdicts["the evening ends in order"] = [str(error)]
    return report(verdicts)


def soak(minutes: float, seed: int) -> dict[str, list[str]]:
    """Why what must be true is not, by what must be true."""
    with Battle(ROBOTS, ROBOTS, **RULES) as battle:
        robots = LightRobots(LIGHT, f"http://127.0.0.1:{battle.ports['LASERBOT_ROS_PORT']}", battle.web)
        try:
            until(lambda: not absent(battle), 60, "bots and light robots are there")
            robots.fight(HITS)
            evening = Evening(battle, seed)
            evening.pass_by(minutes)
            return {what: ask() for what, ask in evening.checks().items()}
        finally:
            LOG.write_text(battle.log)
            robots.close()


def report(verdicts: dict[str, list[str]]) -> int:
    """The table; returns the exit code."""
    print(f"\nlog: {LOG}\nload average {os.getloadavg()[0]:.1f}, {competitors():.1f} programs for each processor")
    for what, reasons in verdicts.items():
        print(f"{'FAILED' if reasons else 'ok':8}{what}")
        for reason in reasons:
            print(f"{'':8}  {reason}")
    return 1 if any(verdicts.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
