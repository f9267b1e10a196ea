"""Robots that are switched off in order are not lost."""

from server.game.departures import KEPT, Departures
from server.game.loop import GameLoop
from server.game.referee import Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.linked import add_linked_robot
from tests.support.site import whole_site


def test_a_robot_that_leaves_is_remembered_for_a_while_or_until_it_is_back() -> None:
    left = Departures()
    left.pinged(1, leaving=False, now=0)
    assert left.of_late(0) == set()
    left.pinged(1, leaving=True, now=10)
    left.pinged(2, leaving=True, now=20)
    assert left.of_late(20) == {1, 2}
    left.pinged(2, leaving=False, now=30)
    assert left.of_late(30) == {1}
    assert left.of_late(10 + KEPT) == set()


def test_a_last_ping_says_it_and_only_the_robots_own_counts() -> None:
    game = GameLoop(Referee(Rules()), clock=lambda: 1000.0)
    for _ in range(2):
        add_linked_robot(game)
    browser = whole_site(game, Settings.from_env({})).test_client()
    browser.post("/incAlive", data={"ID": "0"})
    assert game.robots_left() == set()
    assert browser.post("/incAlive", data={"ID": "0", "leaving": "1"}).text == '{"status": "OK"}'
    assert browser.post("/incAlive", data={"ID": "0", "leaving": "perhaps"}).status_code == 400
    assert browser.post("/incAlive", data={"ID": "7", "leaving": "1"}).text == '{"status": "ERROR"}'
    other = game.add_robot("another", key="secret")
    refused = browser.post("/incAlive", data={"ID": str(other), "key": "wrong", "leaving": "1"})
    assert refused.status_code == 403
    assert game.robots_left() == {0}
