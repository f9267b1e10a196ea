"""A LAN for each test."""

from collections.abc import Iterator

import pytest

from tests.support.lan import Lan


@pytest.fixture
def lan() -> Iterator[Lan]:
    with Lan() as lan:
        yield lan
