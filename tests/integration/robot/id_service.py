"""The server's service that gives robots their IDs, with answers that the test chooses."""

import re
from pathlib import Path

from tests.support.programs import Program
from tests.support.ros import RosMaster


class IdService:
    """/add_new_robot in a process of its own; `next` is its next answer, "none" makes it fail."""

    def __init__(self, master: RosMaster, file: Path) -> None:
        self._file = file
        self._master = master
        self.give("0")
        self.start()

    def give(self, answer: str) -> None:
        self._file.write_text(answer)

    def start(self) -> None:
        self._program = Program.python("tests.integration.robot.peers", "ids", str(self._file), env=self._master.env)
        self._program.wait_for("ready")

    def kill(self) -> None:
        self._program.kill()

    @property
    def callers(self) -> list[str]:
        """Who has asked for an ID, in order."""
        return re.findall("asked by (.*),", self._program.output)

    @property
    def keys(self) -> list[str]:
        """The digests of the keys that they gave, in order."""
        return re.findall("with key (.*)", self._program.output)
