"""The bots' configuration, what they hear, and when they play."""

import pytest

from laser_bot_battle.geometry import Pose
from laser_bot_battle.msg import GameEvent, GameStatus
from laser_bot_battle.place import Place
from laser_bot_battle.settings import SettingsError
from server.bots.game import Floor, Player, Positions, Status, fights, wants_ready
from server.bots.settings import Settings, first_free


def urls(settings: Settings) -> tuple[str, str]:
    assert settings.place
    return settings.web_url(settings.place), settings.rosbridge_url(settings.place)


def status(game: int, **ready: bool) -> Status:
    return Status(game, tuple(Player(name, n, 100, is_ready) for n, (name, is_ready) in enumerate(ready.items())))


@pytest.mark.parametrize("human", ["Ann", "Botond", "Bot", "Bot_1", "Bot1a", "bot1", "ABot1"])
def test_it_is_ready_when_a_human_is(human: str) -> None:
    assert wants_ready(status(0, Bot1=False, **{human: True}))


@pytest.mark.parametrize(
    "players", [{}, {"Bot1": True}, {"Bot1": True, "Bot20": True}, {"Bot1": True, "Ann": False}], ids=str
)
def test_it_is_not_ready_without_a_ready_human(players: dict[str, bool]) -> None:
    assert not wants_ready(status(1, **players))


def test_a_status_is_read_from_rosbridge() -> None:
    user = {"name": "Ann", "robot": 3, "life": 90, "ready": True, "avatar": 0, "place": 0, "left": False, "session": ""}
    event = {"number": 7, "kind": 0, "name": "Ann", "by": "", "life": 90}
    refused = {**event, "number": 8, "kind": GameEvent.REFUSED}
    message = {"game": GameStatus.PLAYING, "paused": True, "users": [user], "result": [], "events": [event, refused]}
    ann = Player("Ann", 3, 90, True)
    assert Status.from_message(message) == Status(GameStatus.PLAYING, (ann,), paused=True, hits=((7, "Ann"),))
    assert Status.from_message({**message, "protection": 2.5}).protection == 2.5


def test_positions_are_read_from_rosbridge_and_who_is_nowhere_is_left_out() -> None:
    there, lost = {"robot": 3, "x": 1, "y": 0.5, "heading": -1.5}, {"robot": 4, "x": None, "y": 0.5, "heading": 0}
    far = {"robot": 5, "x": 1, "y": -3e38, "heading": 0}
    message = {"width": 1.6, "height": 1.2, "walls": [0, 0, 1, 1, 0.5], "robots": [there, lost, far]}
    assert Positions.from_message(message) == Positions(Floor(1.6, 1.2, ((0, 0, 1, 1),)), {3: Pose(1, 0.5, -1.5)})


@pytest.mark.parametrize("width", [0, -1, 1e6, None, "wide"])
def test_positions_on_no_floor_are_none(width: object) -> None:
    with pytest.raises((TypeError, ValueError)):
        Positions.from_message({"width": width, "height": 1.2, "walls": [], "robots": []})


def test_it_does_not_drive_in_a_pause() -> None:
    me = Player("Bot1", 0, 100, True)
    assert fights(Status(GameStatus.PLAYING, (me,)), me)
    assert not fights(Status(GameStatus.PLAYING, (me,), paused=True), me)


def test_taken_names_are_counted_on() -> None:
    assert [first_free(taken) for taken in (set(), {"Ann", "Bot1", "bot2", "Bot9"})] == ["Bot1", "Bot3"]


def test_everything_is_on_the_master_by_default() -> None:
    assert urls(Settings.read({"LASERBOT_MASTER": "10.0.0.5"})) == ("http://10.0.0.5:5000", "ws://10.0.0.5:9090")


def test_on_the_master_itself_they_go_where_its_programs_listen() -> None:
    own = {"ROS_MASTER_URI": "http://localhost:11311"}
    assert urls(Settings.read(own))[0] == "http://localhost:5000"
    assert urls(Settings.read({**own, "LASERBOT_BIND": "10.0.0.5"})) == ("http://10.0.0.5:5000", "ws://10.0.0.5:9090")
    assert urls(Settings.read({**own, "LASERBOT_BIND": "fd00::5"}))[0] == "http://[fd00::5]:5000"


def test_rosbridge_may_be_elsewhere() -> None:
    assert urls(Settings.read({}, master="master", rosbridge="bridge:80")) == ("http://master:5000", "ws://bridge:80")


def test_without_another_word_the_master_is_where_rosbridge_is() -> None:
    assert urls(Settings.read({}, rosbridge="bridge:80"))[0] == "http://bridge:5000"
    assert urls(Settings.read({"LASERBOT_MASTER": "master"}, rosbridge="bridge:80"))[0] == "http://master:5000"


def test_bots_that_are_told_nothing_find_the_master() -> None:
    settings = Settings.read({"LASERBOT_ARENA": "hall"})
    assert settings.place is None
    assert settings.arena == "hall"
    found = Place("10.0.0.9", 5001, "http://10.0.0.9:11311", "hall", rosbridge=9091)
    assert (settings.web_url(found), settings.rosbridge_url(found)) == ("http://10.0.0.9:5001", "ws://10.0.0.9:9091")


@pytest.mark.parametrize(
    ("env", "arguments"),
    [
        ({"LASERBOT_WEB_PORT": "http"}, {}),
        ({"LASERBOT_ROSBRIDGE_PORT": "65536"}, {}),
        ({"LASERBOT_LOG_LEVEL": "loud"}, {}),
        ({"LASERBOT_LOG_LEVEL": "critical"}, {}),
        ({"LASERBOT_LOG_LEVEL": "notset"}, {}),
        ({}, {"rosbridge": "host"}),
        ({}, {"rosbridge": "host:door"}),
        ({}, {"rosbridge": ":80"}),
    ],
    ids=str,
)
def test_impossible_settings_are_refused(env: dict[str, str], arguments: dict[str, str]) -> None:
    with pytest.raises(SettingsError):
        Settings.read(env, **arguments)
