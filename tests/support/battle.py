"""A whole battle as a user starts it (ci/demo), on free ports, and its processes."""

import contextlib
import os
import re
import shutil
import signal
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from tests.support.ports import free_port
from tests.support.processes import command_line, descendants
from tests.support.programs import ROOT, Program

PORTS = (
    "LASERBOT_WEB_PORT",
    "LASERBOT_ROSBRIDGE_PORT",
    "LASERBOT_RELAY_PORT",
    "LASERBOT_ROS_PORT",
    "LASERBOT_ARENA_PORT",
    "LASERBOT_ARENA_LINK_PORT",
)


class DemoProgram(Program):
    """`ci/demo`, whose parts write into one log."""

    def __init__(self, words: Sequence[str], environment: Mapping[str, str], log: Path) -> None:
        self._parts_log = log
        super().__init__([str(ROOT / "ci" / "demo"), *words], environment)

    @property
    def log(self) -> str:
        with contextlib.suppress(OSError):  # it has not begun, or is tidied away
            return self._parts_log.read_text(errors="replace")
        return self.output


class Battle:
    """`ci/demo` with `robots` virtual robots, `bots` bots and further options; `variables` are LASERBOT_ settings,
    ports too. Unless they say otherwise, everybody can be hit from the start of a battle, and nobody drives before it.
    """

    def __init__(self, robots: int = 2, bots: int = 0, *options: str, **variables: str) -> None:
        self.ports = {variable: int(variables.get(variable) or free_port()) for variable in PORTS}
        ports = {name: str(port) for name, port in self.ports.items()}
        environment = {**ports, "LASERBOT_PROTECTION": "0", "LASERBOT_PRACTICE": "0", **variables}
        words = ["--robots", str(robots), "--bots", str(bots), *options]
        self.program = DemoProgram(words, environment, self.folder / "log")

    @property
    def web_port(self) -> int:
        return self.ports["LASERBOT_WEB_PORT"]

    @property
    def web(self) -> str:
        return f"http://127.0.0.1:{self.web_port}"

    @property
    def arena_port(self) -> int:
        return self.ports["LASERBOT_ARENA_PORT"]

    @property
    def rosbridge_port(self) -> int:
        return self.ports["LASERBOT_ROSBRIDGE_PORT"]

    @property
    def relay_port(self) -> int:
        return self.ports["LASERBOT_RELAY_PORT"]

    @property
    def bridge(self) -> str:
        return f"ws://127.0.0.1:{self.rosbridge_port}"

    @property
    def view(self) -> str:
        return f"ws://127.0.0.1:{self.arena_port}/view"

    @property
    def folder(self) -> Path:
        return ROOT / "build" / f"demo-{self.web_port}"

    @property
    def log(self) -> str:
        """What all parts have said."""
        return self.program.log

    def wait_until_ready(self, seconds: float = 60.0) -> None:
        self.program.wait_for("Ctrl-C stops everything", seconds)

    def pid(self, command: str) -> int:
        """The one running process of this battle whose command line matches the regular expression `command`."""
        parts = descendants(self.program.process.pid)
        matching = [part.pid for part in parts if re.search(command, command_line(part))]
        assert len(matching) == 1, f"{command!r} is {len(matching)} processes of the battle"
        return matching[0]

    def kill(self, command: str) -> None:
        """End that process as a crash does; roslaunch starts it again."""
        os.kill(self.pid(command), signal.SIGKILL)

    def pause(self, command: str) -> "Paused":
        """Within a `with`: that process stands still, as behind a cut network."""
        return Paused(self.pid(command))

    def __enter__(self) -> Self:
        try:
            self.wait_until_ready()
        except AssertionError:
            self.program.kill()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end(is_well=kind is None)

    def end(self, *, is_well: bool) -> None:
        """`is_well`: its log has nothing to tell any more."""
        self.program.stop(seconds=30.0)
        if is_well:
            shutil.rmtree(self.folder)


class Paused:
    """A process that is stopped until the end of the `with`."""

    def __init__(self, pid: int) -> None:
        self.pid = pid

    def __enter__(self) -> None:
        os.kill(self.pid, signal.SIGSTOP)

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        with contextlib.suppress(ProcessLookupError):  # ended meanwhile, which the test may have wanted
            os.kill(self.pid, signal.SIGCONT)
