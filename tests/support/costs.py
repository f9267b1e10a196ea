"""What each test file costs: seconds of processor time, of the tests and of all that they start.

A plugin of pytest: at the end it lists the dearest files. A check that only waits may take long; one that takes much
of a processor makes the others late.
"""

import os
import time
from collections import defaultdict
from collections.abc import Generator
from pathlib import Path

import pytest

TICKS = os.sysconf("SC_CLK_TCK")
LISTED = 20


def family(pid: int | str = "self") -> float:
    """Seconds of processor time that a process, its ended children and its living descendants have used."""
    ticks = 0
    processes = [str(pid)]
    while processes:
        folder = Path("/proc", processes.pop())
        try:
            # the program's name, in brackets, may contain blanks; fields 14 to 17 are utime, stime, cutime, cstime
            words = (folder / "stat").read_text().rpartition(")")[2].split()
            ticks += sum(map(int, words[11:15]))
            for children in folder.glob("task/*/children"):
                processes += children.read_text().split()
        except OSError:  # it has just ended; its parent counts it
            continue
    return ticks / TICKS


class Costs:
    def __init__(self) -> None:
        self._counted, self._since = family(), time.monotonic()
        self._files: defaultdict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        report = yield
        if call.when == "teardown":
            counted, now = family(), time.monotonic()
            # a worker sends the report's attributes to whoever sums up
            vars(report)["cost"] = (counted - self._counted, now - self._since)
            self._counted, self._since = counted, now
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        for i, seconds in enumerate(getattr(report, "cost", ())):
            self._files[report.location[0]][i] += seconds

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if len(self._files) < 2:
            return
        dearest = sorted(self._files.items(), key=lambda item: -item[1][0])
        total = sum(processor for processor, _ in self._files.values())
        terminalreporter.section(f"{total:.0f} s of processor time; the dearest files (processor, clock)")
        for file, (processor, clock) in dearest[:LISTED]:
            terminalreporter.write_line(f"{processor:7.1f} s {clock:7.1f} s  {file}")
