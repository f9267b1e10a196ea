"""Arenas for each test: robots of one test do not stand in the way of another's."""

from collections.abc import Callable, Iterator

import pytest

from tests.integration.sim.arena import Arena


@pytest.fixture
def new_arena() -> Iterator[Callable[..., Arena]]:
    """An arena with these options of its program."""
    arenas: list[Arena] = []

    def new(*options: str) -> Arena:
        arenas.append(Arena(*options))
        return arenas[-1]

    yield new
    for arena in arenas:
        if arena.program.running:
            assert arena.program.stop() == 0
        assert "Traceback" not in arena.program.output, arena.program.output


@pytest.fixture
def arena(new_arena: Callable[..., Arena]) -> Arena:
    return new_arena()
