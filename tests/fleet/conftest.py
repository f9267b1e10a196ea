"""For the tests of the rehearsed fleet: it must be up (make fleet)."""

from collections.abc import Iterator

import pytest

from tests.support.player import Player
from tests.support.rehearsal import INVENTORY, Rehearsal


@pytest.fixture(scope="session")
def rehearsal() -> Rehearsal:
    if not INVENTORY.exists():
        pytest.fail("no fleet is up: make fleet")
    return Rehearsal()


@pytest.fixture
def players(rehearsal: Rehearsal) -> Iterator[tuple[Player, Player]]:
    """Ann and Bob, signed in, each with a robot; all robots must be free before."""
    rehearsal.wait_until_complete()
    with Player(rehearsal, "Ann") as ann, Player(rehearsal, "Bob") as bob:
        yield ann, bob
