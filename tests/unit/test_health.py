"""images/health.py: whom it asks when nothing is set, and when a service listens at one address only."""

import pytest

from images import health
from laser_bot_battle.variables import MASTER


def test_a_robots_master_is_the_one_that_the_robot_itself_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("LASERBOT_MASTER", raising=False)
    assert health.master() == MASTER.read({})


@pytest.mark.parametrize(
    ("bind", "asked"),
    [("", "localhost"), ("0.0.0.0", "localhost"), ("::", "localhost"), ("192.168.1.2", "192.168.1.2")],
)
def test_a_service_is_asked_where_it_listens(monkeypatch: pytest.MonkeyPatch, bind: str, asked: str) -> None:
    monkeypatch.setenv("LASERBOT_BIND", bind)
    assert health.own_host() == asked
