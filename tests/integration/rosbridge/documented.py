"""docs/rosbridge.md as a user follows it; only the port is another one."""

from collections.abc import Iterator

import pytest

from tests.support.documents import blocks, page
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster

PAGE = page("rosbridge.md")
PORT = "9090"


class Lab:
    """rosbridge, started as the page says."""

    def __init__(self, master: RosMaster) -> None:
        self._port = str(free_port())
        (commands,) = blocks(PAGE, "sh")
        *_, start = commands.strip().splitlines()
        self.program = Program(["sh", "-c", f"exec env {self._here(start)}"], master.env)

    def example(self, language: str) -> str:
        """The page's example in that language."""
        (text,) = blocks(PAGE, language)
        return self._here(text)

    def _here(self, text: str) -> str:
        assert PORT in text
        return text.replace(PORT, self._port)


@pytest.fixture(scope="module")
def lab(ros_master: RosMaster) -> Iterator[Lab]:
    running = Lab(ros_master)
    running.program.wait_for("listening")
    yield running
    assert running.program.stop(seconds=3) == 0
