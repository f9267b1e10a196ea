"""What the tests of clients share."""

import pytest

from tests.unit.rosbridge.clients import Server


@pytest.fixture
def server() -> Server:
    return Server()
