"""What a battle needs restarts after its end, and the next battle waits for that."""

import json

import pytest

from server.game import desk
from server.game.loop import GameLoop
from server.game.referee import HOLD, HOLD_AT_MOST, Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.linked import add_linked_robot
from tests.support.site import whole_site

ROBOT_0, ROBOT_2 = "0", "2"  # names
AT = "10.0.0.7"  # where the robots are
WAITS = "The next battle waits: {} is about to restart."


@pytest.fixture
def fight(match):
    """ada (robot 0) and bob (robot 1) fight; robot 2 is nobody's."""
    match.start("ada", "bob")
    return match


def restarting(match, name="", address="", is_local=False):
    """All robots are at `AT`, though the pings of the tests come from nowhere."""
    robots = list(match.referee._state.robots)
    for robot in robots:
        robot.address = AT
    seconds = match.referee.restarting(name, address, match.now, is_local=is_local)
    for robot in robots:
        robot.address = ""
    return seconds


def test_a_robot_of_the_battle_waits_for_its_end(fight):
    assert restarting(fight, ROBOT_0, AT) == pytest.approx(fight.state.time_left)
    fight.hit("bob", 10)
    assert fight.state.game == 0
    assert restarting(fight, ROBOT_0, AT) == 0


def test_at_most_for_the_battles_limit(fight):
    fight.wait(299.5)
    assert restarting(fight, ROBOT_0, AT) == 1
    fight.wait(0.5)
    assert restarting(fight, ROBOT_0, AT) == 0


def test_a_robot_that_is_in_no_battle_waits_for_nothing(fight):
    assert restarting(fight, ROBOT_2, AT) == 0


def test_the_server_waits_for_any_battle(fight):
    assert restarting(fight, is_local=True) == pytest.approx(300)


def test_so_does_what_says_nothing_of_itself_also_in_a_countdown(match):
    assert restarting(match) == 0
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    assert restarting(match) == pytest.approx(15)
    assert match.state.game == 1, "it holds nobody up"


def test_a_robot_that_the_server_does_not_know_is_in_no_battle(fight):
    assert restarting(fight, "unknown", is_local=True) == 0
    assert fight.referee.overview(fight.now)["game"]["why_no_start"] == "runs"


@pytest.mark.parametrize(
    ("asked", "what"),
    [({"name": ROBOT_2, "address": AT}, "robot 2"), ({"is_local": True}, "the server")],
)
def test_the_next_battle_waits_and_everybody_is_told_why(fight, asked, what):
    fight.hit("bob", 10)
    restarting(fight, **asked)
    assert fight.state.notice.startswith("Battle over"), "nobody waits for the next one yet"
    fight.ready("ada", "bob")
    assert fight.state.game == 0
    assert fight.state.notice == WAITS.format(what)
    fight.referee.operate(lambda state, rules: desk.start(state, rules, "op"), fight.now)
    assert fight.state.game == 2, "the operator need not wait"


def test_it_begins_by_itself_some_time_after_the_last_word(match):
    match.sign_up("ada", "bob")
    for _ in range(3):
        restarting(match, is_local=True)
        match.ready("ada", "bob")
        match.wait(HOLD - 1)
        assert match.state.game == 0
    match.wait(1)
    assert match.state.game == 1
    assert match.state.notice == ""
    assert match.state.time_left == pytest.approx(15, abs=0.5)


def test_a_countdown_stops_and_begins_anew(match):
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    match.wait(14)
    assert restarting(match, is_local=True) == 0
    assert (match.state.game, match.state.notice) == (0, WAITS.format("the server"))
    match.wait(HOLD)
    assert match.state.game == 1


@pytest.mark.parametrize(("name", "address"), [(ROBOT_0, "10.0.0.8"), (ROBOT_0, ""), ("", AT), ("unknown", AT)])
def test_nobody_else_can_hold_a_battle_up(fight, name, address):
    fight.hit("bob", 10)
    restarting(fight, name, address)
    fight.ready("ada", "bob")
    assert fight.state.game == 1


def test_a_robot_without_an_address_is_not_anybody(match):
    match.referee.restarting(ROBOT_0, "", match.now)
    match.sign_up("ada", "bob")
    match.ready("ada", "bob")
    assert match.state.game == 1


def test_a_new_program_holds_nothing(match):
    match.sign_up("ada", "bob")
    restarting(match, is_local=True)
    match.ready("ada", "bob")
    match.restart()
    match.wait(0.4)
    match.ready("ada", ready=False)
    match.ready("ada")
    assert match.state.game == 1


def ask_for(match, seconds, **asked):
    """Who asks does so each second."""
    for _ in range(int(seconds)):
        restarting(match, **asked)
        match.wait(1)


def begin(match):
    match.ready("ada", "bob")
    match.wait(15)
    assert match.state.game == 2


def begins(match):
    """Whether the next battle does. Each beginning is taken back."""
    match.ready("ada", "bob")
    began = match.state.game == 1
    match.ready("ada", "bob", ready=False)
    return began


@pytest.mark.parametrize("asked", [{"name": ROBOT_2, "address": AT}, {"name": ROBOT_0, "address": AT}])
def test_a_robot_that_asks_for_ever_holds_only_for_a_while(match, asked):
    match.sign_up("ada", "bob")
    ask_for(match, HOLD_AT_MOST - 1, **asked)
    assert not begins(match)
    ask_for(match, 2, **asked)
    assert begins(match)
    begin(match)
    restarting(match, **asked)
    match.hit("bob", 10)
    ask_for(match, 60, **asked)
    assert begins(match), "nor a later battle"


def test_the_wait_for_its_battle_is_not_counted(fight):
    for _ in range(3):
        ask_for(fight, 90, name=ROBOT_0, address=AT)
    fight.hit("bob", 10)
    restarting(fight, ROBOT_0, AT)
    assert not begins(fight)


def test_it_may_hold_again_when_it_has_restarted(match):
    match.sign_up("ada", "bob")
    ask_for(match, HOLD_AT_MOST + 1, name=ROBOT_2, address=AT)
    assert begins(match)
    match.register(f"/id_service_client_{ROBOT_2}")
    restarting(match, ROBOT_2, AT)
    assert not begins(match)


def test_another_one_holds_for_its_own_while(match):
    match.sign_up("ada", "bob")
    ask_for(match, HOLD_AT_MOST, name=ROBOT_2, address=AT)
    restarting(match, ROBOT_0, AT)
    restarting(match, ROBOT_2, AT)
    assert not begins(match)
    assert match.state.notice == "", "nobody is ready"


def test_the_servers_programs_may_hold_once_a_battle(match):
    match.sign_up("ada", "bob")
    ask_for(match, HOLD_AT_MOST + 1, is_local=True)
    assert begins(match)
    begin(match)
    match.hit("bob", 10)
    restarting(match, is_local=True)
    assert not begins(match)


class Site:
    def __init__(self) -> None:
        self.game = GameLoop(Referee(Rules()), clock=lambda: 0.0)
        self.game.add_robot("/id_service_client_a", address=AT)
        for name in ("al", "bo"):
            add_linked_robot(self.game)
            self.game.sign_up(name, name, 0)
            self.game.set_ready(name, True, name)
        self.browser = whole_site(self.game, Settings.from_env({})).test_client()

    def ask(self, address: str, **headers: str) -> int:
        environ = {"REMOTE_ADDR": address}
        answer = self.browser.post("/restarting", data={"robot": "a"}, environ_base=environ, headers=headers)
        return int(json.loads(answer.text)["wait"])


@pytest.mark.parametrize(
    ("address", "headers", "holds"),
    [
        (AT, {}, True),
        ("127.0.0.1", {}, True),
        ("::1", {}, True),
        ("10.0.0.8", {}, False),
        ("10.0.0.8", {"X-Forwarded-For": AT}, False),
        ("127.0.0.1", {"X-Forwarded-For": "10.0.0.8"}, False),
        ("127.0.0.1", {"X-Forwarded-For": AT}, True),
    ],
)
def test_who_is_believed_over_http(address, headers, holds):
    site = Site()
    assert site.game.snapshot().game == 1
    assert site.ask(address, **headers) == (0 if holds else 15)
    assert site.game.snapshot().game == (0 if holds else 1)
