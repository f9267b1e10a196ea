"""An arena for each test: robots of one test do not stand in the way of another's."""

from collections.abc import Iterator

import pytest

from tests.integration.sim.arena import Arena


@pytest.fixture
def arena() -> Iterator[Arena]:
    arena = Arena()
    try:
        yield arena
    finally:
        if arena.program.running:
            assert arena.program.stop() == 0
        assert "Traceback" not in arena.program.output, arena.program.output
