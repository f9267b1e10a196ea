"""Where the master is: as the settings say, else as the network does."""

import asyncio

import pytest

from laser_bot_battle import place, search
from laser_bot_battle.announcement import Announcement, NoArenaError, UnheardError
from laser_bot_battle.place import Place, locate
from laser_bot_battle.settings import SettingsError

HALL = Announcement("hall", ("10.9.0.1",), 5001, 9091, 11312, "1.0.0")


def heard(monkeypatch: pytest.MonkeyPatch, result: tuple[Announcement, str] | NoArenaError, known: bool) -> None:
    """The network says so; `known` is whether a name server knows the usual name."""

    async def find(wanted: str) -> tuple[Announcement, str]:
        if isinstance(result, NoArenaError):
            raise result
        return result

    async def is_known(host: str) -> bool:
        return known

    monkeypatch.setattr(search, "find", find)
    monkeypatch.setattr(place, "_is_known", is_known)


def test_nothing_is_given_by_default() -> None:
    assert Place.given({}) is None
    assert Place.given({"LASERBOT_MASTER": "", "ROS_MASTER_URI": ""}) is None


def test_laserbot_master_comes_before_ros_master_uri() -> None:
    given = Place.given(
        {"LASERBOT_MASTER": "10.0.0.5", "ROS_MASTER_URI": "http://ros:11312", "LASERBOT_WEB_PORT": "80"}
    )
    assert given == Place("10.0.0.5", 80, "http://ros:11312")
    assert str(given) == "master at 10.0.0.5, as LASERBOT_MASTER says"


def test_ros_master_uri_alone_tells_the_host() -> None:
    given = Place.given({"ROS_MASTER_URI": "http://ros:11312"})
    assert given == Place("ros", 5000, "http://ros:11312")
    assert str(given) == "master at ros, as ROS_MASTER_URI says"


@pytest.mark.parametrize("variable", ["LASERBOT_WEB_PORT", "ROS_MASTER_URI"])
def test_an_impossible_value_is_named_even_if_it_is_not_needed(variable: str) -> None:
    with pytest.raises(SettingsError, match=variable):
        Place.given({variable: "x"})


def test_a_child_process_is_told_the_same_place() -> None:
    found = Place.announced(HALL, "10.9.0.1")
    told = Place.given(found.environment())
    assert told == Place("10.9.0.1", 5001, "http://10.9.0.1:11312")


def test_what_is_given_is_not_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    heard(monkeypatch, (HALL, "10.9.0.1"), known=True)
    assert asyncio.run(locate({"LASERBOT_MASTER": "10.0.0.5"}, "")).host == "10.0.0.5"


def test_an_announced_arena_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    heard(monkeypatch, (HALL, "10.9.0.1"), known=True)
    found = asyncio.run(locate({}, ""))
    assert found == Place("10.9.0.1", 5001, "http://10.9.0.1:11312", "hall", 9091)
    assert str(found) == "arena 'hall' at 10.9.0.1, announced"


def test_where_nothing_is_heard_the_usual_name_is_taken_if_it_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    heard(monkeypatch, UnheardError("nothing"), known=True)
    found = asyncio.run(locate({"LASERBOT_WEB_PORT": "80"}, ""))
    assert found == Place("laser_bot_master.local", 80, "http://laser_bot_master.local:11311")
    heard(monkeypatch, UnheardError("nothing"), known=False)
    with pytest.raises(UnheardError):
        asyncio.run(locate({}, ""))


def test_who_was_given_a_name_or_hears_several_arenas_does_not_go_to_the_usual_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heard(monkeypatch, UnheardError("nothing"), known=True)
    with pytest.raises(UnheardError):
        asyncio.run(locate({}, "hall"))
    heard(monkeypatch, NoArenaError("several"), known=True)
    with pytest.raises(NoArenaError):
        asyncio.run(locate({}, ""))
