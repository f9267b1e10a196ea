"""Who sees what: the table of docs/protocol-camera.md, with real battles of a referee."""

import time
from collections.abc import Callable, Iterator, Mapping

import pytest

from laser_bot_battle.names import operator_ticket, session_digest, session_ticket
from tests.integration.camera.conftest import COUNTDOWN, PLAYING, STOPPED, Relay
from tests.integration.rosbridge.ends import RosSide, player
from tests.support.fake_camera import FakeCamera
from tests.support.ros import RosMaster
from tests.support.viewer import Viewer

Start = Callable[..., tuple[int, FakeCamera]]
Connect = Callable[..., Viewer]

FOREIGN = {"Origin": "http://evil.example"}
OWN = {"Origin": "http://127.0.0.1:5000"}


class Hall:
    """Two robots; al fights with one, bo has the other and looks on. The operator sees both."""

    def __init__(self, camera: Start, viewer: Connect, referee: RosSide) -> None:
        (self.one, _), (self.two, _) = camera(), camera()
        self.viewer, self._referee = viewer, referee
        self.al = player("al", "token-of-al", self.one)
        self.bo = player("bo", "token-of-bo", self.two, ready=False)
        self.operator = self.looks("", self.one)
        self.operator.operate()
        self.operator.metrics()  # so it is one

    def looks(self, token: str, robot: int, headers: Mapping[str, str] | None = None) -> Viewer:
        looking = self.viewer(token, headers)
        looking.watch(robot)
        return looking

    def says(self, game: int, *users: dict[str, object], hide: bool = False) -> None:
        self._referee.status(game, *(users or (self.al, self.bo)), hide_cameras=hide)


@pytest.fixture
def hall(camera: Start, viewer: Connect, referee: RosSide) -> Iterator[Hall]:
    yield Hall(camera, viewer, referee)


@pytest.mark.parametrize("game", [COUNTDOWN, PLAYING])
def test_a_player_in_battle_sees_only_the_own(hall: Hall, game: int) -> None:
    own, others = hall.looks("token-of-al", hall.one), hall.looks("token-of-al", hall.two)
    others.picture()
    hall.says(game)
    assert others.state("refused") == "in a battle you see through your own robot's camera only"
    assert others.sees_nothing_while(hall.operator)
    own.picture()
    assert own.states[-1][1] == "live"
    others.watch(hall.one)
    others.picture(lambda shot: shot.robot == hall.one)
    others.watch(hall.two)
    assert others.state("refused", hall.two)
    hall.says(STOPPED)  # the wish stands
    others.state("live", hall.two)
    others.picture(lambda shot: shot.robot == hall.two)


def test_spectators_see_all_unless_the_cameras_are_hidden(hall: Hall) -> None:
    guest, own, signed_in = hall.looks("", hall.one), hall.looks("token-of-bo", hall.two), hall.viewer("token-of-bo")
    hall.says(PLAYING)
    guest.picture()
    hall.says(PLAYING, hide=True)
    assert guest.state("refused") == "the cameras are hidden while a battle runs"
    signed_in.watch(hall.one)
    assert signed_in.state("refused")
    assert guest.sees_nothing_while(hall.operator)
    assert signed_in.sees_nothing_while(hall.operator)
    own.drain()
    assert own.picture().robot == hall.two
    assert own.states[-1][1] == "live"
    hall.says(STOPPED, hide=True)
    guest.state("live")
    guest.picture()


def test_who_is_signed_out_sees_as_a_spectator_does(hall: Hall) -> None:
    hall.says(PLAYING, hide=True)
    al = hall.looks("token-of-al", hall.one)
    al.picture()
    hall.says(PLAYING, hall.bo, hide=True)
    assert al.state("refused") == "the cameras are hidden while a battle runs"
    assert al.sees_nothing_while(hall.operator)


def test_whose_robot_is_exchanged_sees_through_the_new_one(hall: Hall) -> None:
    hall.says(PLAYING)
    al = hall.looks("token-of-al", hall.one)
    al.picture()
    hall.says(PLAYING, {**hall.al, "robot": hall.two}, {**hall.bo, "robot": hall.one})
    assert al.state("refused", hall.one)
    al.watch(hall.two)
    al.picture(lambda shot: shot.robot == hall.two)


def test_operators_see_all_always(hall: Hall) -> None:
    hall.says(PLAYING, hide=True)
    guest = hall.looks("", hall.two)
    assert guest.state("refused")
    guest.say("auth", mac=operator_ticket("the operators' token", time.time()))
    guest.picture(lambda shot: shot.robot == hall.two)
    guest.watch(hall.one)
    guest.picture(lambda shot: shot.robot == hall.one)


def test_a_page_at_another_address_sees_nothing_until_it_shows_a_ticket_that_is_right(hall: Hall) -> None:
    hall.says(PLAYING)
    page = hall.looks("token-of-al", hall.one, FOREIGN)
    assert "not at the game's own address" in page.state("refused")
    hall.says(STOPPED)
    page.watch(hall.two)
    assert page.state("refused", hall.two)
    assert page.sees_nothing_while(hall.operator)
    page.operate("guess")
    assert "no player has this name and this token" in page.error()
    assert page.sees_nothing_while(hall.operator)
    page.say("auth", client="al", mac=session_ticket(session_digest("token-of-al"), time.time()))
    page.picture(lambda shot: shot.robot == hall.two)


def test_a_page_of_the_game_is_known_by_its_cookie(hall: Hall) -> None:
    hall.says(PLAYING, hide=True)
    hall.looks("token-of-al", hall.one, OWN).picture()
    assert hall.looks("", hall.one, OWN).state("refused")


def test_when_the_referee_falls_silent_the_rule_stands(
    hall: Hall, referee: RosSide, relay: Relay, ros_master: RosMaster
) -> None:
    hall.says(PLAYING, hide=True)
    guest, al = hall.looks("", hall.one), hall.looks("token-of-al", hall.one)
    assert guest.state("refused")
    referee.freeze(True)
    try:
        al.picture()
        guest.watch(hall.two)
        assert guest.state("refused", hall.two)
        assert guest.sees_nothing_while(al)
    finally:
        referee.freeze(False)
