"""What each request waits for: its lane."""

import pytest

from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.robot_health import RobotsHealth
from server.game.rules import Rules
from server.web.lanes import Lane
from server.web.routes import OwnRoutes
from server.web.settings import Settings
from server.web.watch import create_watch
from tests.support.site import whole_site


@pytest.fixture(scope="module")
def routes() -> OwnRoutes:
    battle = GameLoop(Referee(Rules()))
    return OwnRoutes(whole_site(battle, Settings.from_env({}), create_watch(battle, RobotsHealth())))


@pytest.mark.parametrize(
    ("request_", "lane"),
    [
        ("POST /incAlive", Lane.ROBOTS),
        ("POST /restarting", Lane.ROBOTS),
        ("POST /signUpUser", Lane.PLAYERS),
        ("POST /signOutUser", Lane.PLAYERS),
        ("POST /takeRobot", Lane.PLAYERS),
        ("POST /playerReady", Lane.PLAYERS),
        ("POST /chooseTeam", Lane.PLAYERS),
        ("POST /updateGameStatus", Lane.PLAYERS),
        ("POST /getAvailableRobots", Lane.PLAYERS),
        ("GET /session", Lane.PLAYERS),
        ("POST /operator/login", Lane.PLAYERS),
        ("POST /operator/battle", Lane.PLAYERS),
        ("GET /operator", Lane.LISTS),
        ("HEAD /operator", Lane.LISTS),
        ("GET /operator/state", Lane.LISTS),
        ("GET /operator/log.csv", Lane.LISTS),
        ("GET /watch.json", Lane.LISTS),
        ("GET /", Lane.PAGES),
        ("GET /results", Lane.PAGES),
        ("GET /results.csv", Lane.PAGES),
        ("GET /watch", Lane.PAGES),
        ("POST /audience/cheer", Lane.PAGES),
        ("GET /operators", Lane.PAGES),
        ("GET /nowhere", Lane.PAGES),
    ],
)
def test_who_plays_waits_for_nobody_who_looks(routes: OwnRoutes, request_: str, lane: Lane) -> None:
    assert routes.lane(*request_.split()) is lane
