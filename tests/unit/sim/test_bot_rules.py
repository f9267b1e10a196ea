"""The bot's configuration and when it plays."""

import pytest

from laser_bot_battle.msg import GameStatus
from laser_bot_battle.place import Place
from laser_bot_battle.settings import SettingsError
from sim.bot import fights, wants_ready
from sim.bot_game import Player, Status
from sim.bot_settings import Settings, first_free


def urls(settings: Settings) -> tuple[str, str, str]:
    assert settings.place
    place = settings.place
    return settings.web_url(place), settings.rosbridge_url(place), settings.view_url(place)


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
    message = {"game": GameStatus.PLAYING, "paused": True, "users": [user], "result": [], "events": [event]}
    ann = Player("Ann", 3, 90, True)
    assert Status.from_message(message) == Status(GameStatus.PLAYING, (ann,), paused=True, hits=((7, "Ann"),))
    assert Status.from_message({**message, "protection": 2.5}).protection == 2.5


def test_it_does_not_drive_in_a_pause() -> None:
    me = Player("Bot1", 0, 100, True)
    assert fights(Status(GameStatus.PLAYING, (me,)), me)
    assert not fights(Status(GameStatus.PLAYING, (me,), paused=True), me)


def test_taken_names_are_counted_on() -> None:
    taken = {"Ann", "Bot1", "bot2", "Bot9", "Bot99"}
    found = [first_free(name, taken) for name in ("Bot0", "Bot1", "Bot9", "Bot99")]
    assert found == ["Bot0", "Bot3", "Bot10", "Bot100"]


def test_everything_is_on_the_master_by_default() -> None:
    settings = Settings.read({"LASERBOT_MASTER": "10.0.0.5", "LASERBOT_ARENA_PORT": "8090"})
    assert urls(settings) == ("http://10.0.0.5:5000", "ws://10.0.0.5:9090", "ws://10.0.0.5:8090/view")


def test_rosbridge_and_the_arena_may_be_elsewhere() -> None:
    settings = Settings.read({}, master="master", rosbridge="bridge:80", arena="other:81")
    assert urls(settings) == ("http://master:5000", "ws://bridge:80", "ws://other:81/view")


def test_without_another_word_the_master_is_where_rosbridge_is() -> None:
    assert urls(Settings.read({}, rosbridge="bridge:80"))[0] == "http://bridge:5000"
    assert urls(Settings.read({"LASERBOT_MASTER": "master"}, rosbridge="bridge:80"))[0] == "http://master:5000"


def test_a_bot_that_is_told_nothing_finds_the_master() -> None:
    settings = Settings.read({"LASERBOT_ARENA": "hall"})
    assert settings.place is None
    assert settings.arena == "hall"
    found = Place("10.0.0.9", 5001, "http://10.0.0.9:11311", "hall", rosbridge=9091)
    assert settings.web_url(found) == "http://10.0.0.9:5001"
    assert settings.rosbridge_url(found) == "ws://10.0.0.9:9091"
    assert settings.view_url(found) == "ws://10.0.0.9:8080/view"


@pytest.mark.parametrize(
    ("env", "arguments"),
    [
        ({"LASERBOT_WEB_PORT": "http"}, {}),
        ({"LASERBOT_ROSBRIDGE_PORT": "65536"}, {}),
        ({"LASERBOT_LOG_LEVEL": "loud"}, {}),
        ({"LASERBOT_LOG_LEVEL": "critical"}, {}),
        ({"LASERBOT_LOG_LEVEL": "notset"}, {}),
        ({}, {"name": "Ann"}),
        ({}, {"name": "Bot"}),
        ({}, {"name": "Botond"}),
        ({}, {"name": "Bot" + "1" * 14}),
        ({}, {"rosbridge": "host"}),
        ({}, {"arena": "host"}),
        ({}, {"arena": "host:door"}),
        ({}, {"arena": ":80"}),
        ({}, {"robot": "128"}),
        ({}, {"robot": "-1"}),
    ],
    ids=str,
)
def test_impossible_settings_are_refused(env: dict[str, str], arguments: dict[str, str]) -> None:
    with pytest.raises(SettingsError):
        Settings.read(env, **arguments)
