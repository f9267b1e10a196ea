"""Who may drive, seen from the WebSocket and from the robot."""

import socket
from collections.abc import Callable, Iterator, Mapping

import pytest

from laser_bot_battle.master import Master
from laser_bot_battle.msg import GameStatus
from tests.integration.rosbridge.ends import COMMAND_TYPE, FORWARD, NEUTRAL, Client, RosSide, player
from tests.support.polling import until
from tests.support.ros import RosMaster

AL, BO = player("al", "token-of-al", 0), player("bo", "token-of-bo", 1)
STOPPED, PLAYING = GameStatus.STOPPED, GameStatus.PLAYING

Connect = Callable[..., Client]


@pytest.fixture
def duel(ros: RosSide, client: Connect) -> Iterator["Duel"]:
    """al and bo fight with robots 0 and 1, and both robots listen."""
    duel = Duel(ros, client)
    yield duel
    duel.says(STOPPED)  # heard, or the next test's first word could be taken for this one's last


class Duel:
    def __init__(self, ros: RosSide, client: Connect) -> None:
        self.ros = ros
        self.watcher = client()
        self.watcher.watch()
        self.seen = {0: 0, 1: 0}
        self.says(PLAYING, AL, BO)

    def says(self, game: int, *users: dict[str, object]) -> None:
        """The referee speaks, and rosbridge has heard it."""
        self.ros.status(game, *users)
        names = [user["name"] for user in users]
        until(lambda: [user["name"] for user in self.watcher.hear_status(game)["users"]] == names)

    def ready(self, driver: Client, robot: int) -> None:
        """Commands of `driver` reach the robot from here on."""
        self.ros.listen(f"/Robot{robot}/command")
        count = len(self.ros.heard(f"/Robot{robot}/command"))

        def arrives() -> bool:
            driver.drive(robot, NEUTRAL)
            return len(self.ros.heard(f"/Robot{robot}/command")) > count

        until(arrives, what=f"a command at robot {robot}")
        self.settle(driver, robot)

    def settle(self, driver: Client, robot: int) -> None:
        """All commands so far have arrived; what comes later is told by `heard`."""
        marker = {"linear_x": 0, "angular_z": 0, "shoot": True}
        driver.drive(robot, marker)
        driver.drive(robot, NEUTRAL)
        topic = f"/Robot{robot}/command"
        until(lambda: self.ros.heard(topic)[-2:] == [marker, NEUTRAL], what=f"the marker at robot {robot}")
        self.seen[robot] = len(self.ros.heard(topic))

    def heard(self, robot: int) -> list[dict[str, object]]:
        return self.ros.heard(f"/Robot{robot}/command")[self.seen[robot] :]

    def robot_hears(self, robot: int, *commands: Mapping[str, object]) -> None:
        until(lambda: self.heard(robot) == list(commands), 5, f"{commands}, not {self.heard(robot)}")


def test_players_drive_their_own_robots(duel: Duel, client: Connect) -> None:
    al, bo = client("token-of-al"), client("token-of-bo")
    duel.ready(al, 0)
    duel.ready(bo, 1)
    turn = {"linear_x": 0, "angular_z": -1, "shoot": True}
    al.drive(0)
    bo.drive(1, turn)
    duel.robot_hears(0, FORWARD)
    duel.robot_hears(1, turn)


def test_a_client_may_be_quicker_than_the_news_of_its_player(
    duel: Duel, client: Connect, ros_master: RosMaster
) -> None:
    with_cookie, with_auth = client("token-of-cy"), client()
    with_cookie.advertise(2)
    with_auth.say("auth", client="di", mac="token-of-di")
    with_auth.advertise(3)
    duel.says(STOPPED, player("cy", "token-of-cy", 2), player("di", "token-of-di", 3))
    master = Master(ros_master.uri, "/test")
    until(lambda: {"/Robot2/command", "/Robot3/command"} <= {topic for topic, _ in master.call("getSystemState")[0]})


def test_no_player_drives_the_robot_of_another(duel: Duel, client: Connect) -> None:
    al, bo = client("token-of-al"), client("token-of-bo")
    duel.ready(al, 0)
    bo.say("advertise", topic="/Robot0/command", type=COMMAND_TYPE, id="a1")
    assert bo.hear()["id"] == "a1"
    bo.drive(0)
    assert "bo may publish on /Robot1/command only" in bo.hear_error()
    al.drive(0)
    duel.robot_hears(0, FORWARD)


def test_guests_only_watch(duel: Duel, client: Connect) -> None:
    guest = client()
    guest.drive(0)
    assert "only signed-in players and operators may publish" in guest.hear_error()
    guest.say("subscribe", topic="/Robot0/command", type=COMMAND_TYPE)
    assert "only operators may subscribe" in guest.hear_error()
    guest.say("call_service", service="/add_new_robot", id="c")
    assert "only operators may call /add_new_robot" in guest.hear_error()
    answer = guest.hear()
    assert (answer["op"], answer["result"], answer["id"]) == ("service_response", False, "c")
    guest.watch()
    al = guest.hear_status(PLAYING)["users"][0]
    assert (al["name"], al["session"]) == ("al", "")  # what proves who is al stays here


def test_a_held_key_that_is_refused_is_told_so_once_a_second(duel: Duel, client: Connect) -> None:
    guest = client()
    for _ in range(20):
        guest.drive(0)
    guest.say("unknown", id="end")
    guest.hear_error()
    assert guest.hear()["id"] == "end"


def test_the_cookie_counts_only_from_pages_of_this_host(duel: Duel, client: Connect) -> None:
    ours = client("token-of-al", Origin="http://127.0.0.1:5000")
    duel.ready(ours, 0)
    for origin in ("http://evil.example", "http://127.0.0.1:8000"):
        theirs = client("token-of-al", Origin=origin)
        theirs.drive(0)
        assert "only signed-in players" in theirs.hear_error()


def test_the_cookie_counts_from_pages_of_the_address_that_a_proxy_was_asked_for(duel: Duel, client: Connect) -> None:
    told = {"X-Forwarded-Host": "arena.local", "X-Forwarded-Proto": "https"}
    duel.ready(client("token-of-al", Origin="https://arena.local", **told), 0)
    theirs = client("token-of-al", Origin="http://arena.local", **told)
    theirs.drive(0)
    assert "only signed-in players" in theirs.hear_error()


def test_a_client_without_cookie_authenticates(duel: Duel, client: Connect) -> None:
    al = client()
    al.say("auth", client="al", mac="token-of-al", dest="", rand="", t=0, level="", end=0)
    duel.ready(al, 0)
    al.drive(0)
    duel.robot_hears(0, FORWARD)


def test_who_authenticates_before_rosbridge_knows_of_the_sign_up_is_let_in(duel: Duel, client: Connect) -> None:
    cy = client()
    cy.say("auth", client="cy", mac="token-of-cy")
    duel.says(PLAYING, AL, BO, player("cy", "token-of-cy", 2))
    duel.seen[2] = 0
    duel.ready(cy, 2)


@pytest.mark.slow
def test_a_wrong_token_changes_nothing(duel: Duel, client: Connect) -> None:
    al = client("token-of-al")
    al.say("auth", client="al", mac="guess", id=5)
    answer = al.hear()
    assert "no player has this name and this token" in answer["msg"]
    assert answer["id"] == 5
    al.say("auth", client="bo", mac="token-of-al")
    assert "no player has this name" in al.hear_error()
    al.operate("guess")
    assert "no player has this name" in al.hear_error()
    duel.says(PLAYING, AL, BO)  # again: meanwhile the referee was silent for too long
    duel.ready(al, 0)


def test_operators_drive_at_any_time(duel: Duel, client: Connect) -> None:
    duel.says(STOPPED)
    operator = client().operate()
    operator.advertise(1)
    duel.ready(operator, 1)
    operator.drive(1)
    duel.robot_hears(1, FORWARD)


@pytest.mark.parametrize(
    ("game", "al", "reason"),
    [
        (STOPPED, AL, "no battle is running"),
        (PLAYING, player("al", "another token", 0), "only signed-in players"),
    ],
    ids=["end of the battle", "signed out"],
)
def test_the_robot_stops_when_the_right_to_drive_ends(
    duel: Duel, client: Connect, game: int, al: dict[str, object], reason: str
) -> None:
    driver = client("token-of-al")
    duel.ready(driver, 0)
    driver.drive(0)
    duel.robot_hears(0, FORWARD)
    duel.ros.status(game, al, BO)
    duel.robot_hears(0, FORWARD, NEUTRAL)
    driver.drive(0)
    assert reason in driver.hear_error()
    assert duel.heard(0) == [FORWARD, NEUTRAL]


def test_the_robot_stops_when_the_socket_closes(duel: Duel, client: Connect) -> None:
    al, bo = client("token-of-al"), client("token-of-bo")
    duel.ready(al, 0)
    duel.ready(bo, 1)
    al.drive(0)
    bo.drive(1)
    duel.robot_hears(0, FORWARD)
    al.close()
    duel.robot_hears(0, FORWARD, NEUTRAL)
    duel.robot_hears(1, FORWARD)


def test_the_robot_stops_when_the_browser_dies(duel: Duel, client: Connect) -> None:
    al = client("token-of-al")
    duel.ready(al, 0)
    al.drive(0)
    duel.robot_hears(0, FORWARD)
    al.socket.socket.shutdown(socket.SHUT_RDWR)
    duel.robot_hears(0, FORWARD, NEUTRAL)


def test_the_robot_stops_when_its_driver_no_longer_advertises(duel: Duel, client: Connect) -> None:
    al = client("token-of-al")
    duel.ready(al, 0)
    al.drive(0)
    al.say("unadvertise", topic="/Robot0/command")
    duel.robot_hears(0, FORWARD, NEUTRAL)


def test_the_robot_stops_when_the_referee_falls_silent(duel: Duel, client: Connect) -> None:
    al = client("token-of-al")
    duel.ready(al, 0)
    al.drive(0)
    duel.robot_hears(0, FORWARD, NEUTRAL)
    al.drive(0)
    assert "nothing heard from the referee" in al.hear_error()


def test_a_command_that_is_none_is_refused_and_changes_nothing(duel: Duel, client: Connect) -> None:
    al = client("token-of-al")
    duel.ready(al, 0)
    for bad in ({"linear_x": 200}, {"linear_x": "1"}, {"shoot": 1}, {"speed": 1}, [1, 0, False], None):
        al.drive(0, bad)  # type: ignore[arg-type]
        al.hear_error()
    al.drive(0)
    duel.robot_hears(0, FORWARD)
