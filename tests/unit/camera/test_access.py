"""Who sees what: the table of docs/protocol-camera.md."""

import pytest

from laser_bot_battle.msg import GameStatus, UserStatus
from laser_bot_battle.names import ABOVE
from server.access.identity import FOREIGN_GUEST, GUEST, OPERATOR, Identity, session_identity
from server.camera.access import CameraAccess
from tests.support.documents import page

# al fights with robot 0, bo has robot 1 and looks on, cy has signed out
AL, BO, CY = (session_identity(name) for name in ("al", "bo", "cy"))
STOPPED, COUNTDOWN, PLAYING = GameStatus.STOPPED, GameStatus.COUNTDOWN, GameStatus.PLAYING
FREE, HIDDEN = False, True


def access(game: int, hide: bool) -> CameraAccess:
    new = CameraAccess("secret")
    users = [
        UserStatus(name="al", robot=0, ready=True, session=AL.session),
        UserStatus(name="bo", robot=1, ready=False, session=BO.session),
    ]
    new.hear(GameStatus(game=game, hide_cameras=hide, users=users))
    return new


@pytest.mark.parametrize(
    ("who", "game", "hide", "seen"),
    [
        *((OPERATOR, game, hide, {0, 1, 2}) for game in (STOPPED, COUNTDOWN, PLAYING) for hide in (FREE, HIDDEN)),
        *((who, STOPPED, hide, {0, 1, 2}) for who in (AL, BO, CY, GUEST) for hide in (FREE, HIDDEN)),
        *((AL, game, hide, {0}) for game in (COUNTDOWN, PLAYING) for hide in (FREE, HIDDEN)),
        *((who, game, FREE, {0, 1, 2}) for who in (BO, CY, GUEST) for game in (COUNTDOWN, PLAYING)),
        *((BO, game, HIDDEN, {1}) for game in (COUNTDOWN, PLAYING)),
        *((who, game, HIDDEN, set()) for who in (CY, GUEST) for game in (COUNTDOWN, PLAYING)),
        *((FOREIGN_GUEST, game, hide, set()) for game in (STOPPED, COUNTDOWN, PLAYING) for hide in (FREE, HIDDEN)),
    ],
)
def test_the_table(who: Identity, game: int, hide: bool, seen: set[int]) -> None:
    rules = access(game, hide)
    assert {robot for robot in (0, 1, 2) if not rules.refuses(who, robot)} == seen


@pytest.mark.parametrize("game", [STOPPED, COUNTDOWN, PLAYING])
@pytest.mark.parametrize("hide", [FREE, HIDDEN])
def test_where_robots_are_may_be_seen_by_all_of_the_games_own_pages(game: int, hide: bool) -> None:
    rules = access(game, hide)
    assert [rules.refuses(who, ABOVE) for who in (OPERATOR, AL, BO, CY, GUEST)] == [""] * 5
    assert rules.refuses(FOREIGN_GUEST, ABOVE)


def test_a_refusal_says_why() -> None:
    assert access(PLAYING, FREE).refuses(AL, 1) == "in a battle you see through your own robot's camera only"
    assert access(PLAYING, HIDDEN).refuses(GUEST, 1) == "the cameras are hidden while a battle runs"


def test_the_newest_word_of_the_referee_counts() -> None:
    rules = access(PLAYING, HIDDEN)
    assert rules.is_own(AL, 0)
    rules.hear(GameStatus(game=PLAYING, hide_cameras=True, users=[UserStatus(name="al", robot=2, session=AL.session)]))
    assert (rules.is_own(AL, 0), rules.is_own(AL, 2)) == (False, True)
    assert rules.refuses(AL, 0)
    rules.hear(GameStatus(game=PLAYING, hide_cameras=True))
    assert rules.refuses(AL, 2)


def test_before_the_first_word_nothing_is_known() -> None:
    assert not CameraAccess("").is_known
    assert access(STOPPED, FREE).is_known


def test_the_page_has_this_table() -> None:
    section = page("protocol-camera.md").partition("## Who sees what")[2]
    assert [line for line in section.splitlines() if line.startswith("| ")][1:] == [
        "| operators | every camera, always |",
        "| a player in a countdown or battle | only their own robot's |",
        "| a page at another address than the game's own, before it has shown a ticket | none |",
        "| everybody else | every camera; with `LASERBOT_HIDE_CAMERAS=1`, only their own while a countdown or battle "
        "runs |",
    ]
