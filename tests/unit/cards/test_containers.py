"""The containers on a card: what laserbot.txt makes of them, and which the engine is given."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from cards import run
from cards.containers import Container, containers
from cards.engine import EngineError
from cards.laserbot_txt import Card
from cards.store import Store
from tests.support.card_engine import CardEngine

DESCRIBED: dict[str, Container] = {
    "robot": {
        "Image": "rosberry:1",
        "Env": ["LASERBOT_ROBOT_NAME=card", "LASERBOT_ARENA=", "LASERBOT_CAMERA=", "PATH=/usr/bin"],
        "HostConfig": {"ReadonlyRootfs": True},
    },
    "camera": {"Image": "rosberry:1", "Env": ["LASERBOT_CAMERA=/dev/video0"]},
}
OF_A_MASTER: dict[str, Container] = {
    "web": {"Image": "webserver:1", "Env": ["LASERBOT_FLOOR=battle"]},
    "announcer": {"Image": "webserver:1", "Env": ["LASERBOT_ARENA=laser-bot-master"]},
}


@pytest.fixture
def image(tmp_path: Path) -> Path:
    """The archive of the image of the card's own version."""
    (tmp_path / "card").mkdir()
    (tmp_path / "card/role").write_text("robot\n")
    (tmp_path / "card/image.tar").write_text("rosberry:1")
    return tmp_path / "card/image.tar"


def arrange(engine: CardEngine, wanted: Mapping[str, Container], image: Path) -> None:
    run.arrange(engine, wanted, Store(image.parents[1] / "state", image.parent), "1")


ANY = Card()


def wanted(card: Card = ANY, host: str = "r1") -> dict[str, Container]:
    return containers(card, host, DESCRIBED)


def test_an_unchanged_card_runs_the_robot_that_looks_for_the_only_arena() -> None:
    [(name, robot)] = wanted().items()
    assert name == "laserbot-robot"
    assert robot["Env"] == ["LASERBOT_ROBOT_NAME=r1", "LASERBOT_ARENA=", "LASERBOT_CAMERA=", "PATH=/usr/bin"]
    assert robot["HostConfig"] == {"ReadonlyRootfs": True}


def test_the_settings_reach_the_containers_that_know_them() -> None:
    found = wanted(Card(arena="hall", camera="/dev/video2"))
    assert {"LASERBOT_ARENA=hall", "LASERBOT_CAMERA=/dev/video2"} <= set(found["laserbot-robot"]["Env"])
    assert found["laserbot-camera"]["Env"] == ["LASERBOT_CAMERA=/dev/video2"]


@pytest.mark.parametrize(
    "card, announced", [(Card(role="master"), "laser-bot-master"), (Card(role="master", arena="hall"), "hall")]
)
def test_a_masters_card_runs_all_that_a_master_has(card: Card, announced: str, image: Path) -> None:
    found = containers(card, "laser-bot-master", OF_A_MASTER)
    assert {name: container["Env"] for name, container in found.items()} == {
        "laserbot-web": ["LASERBOT_FLOOR=battle"],
        "laserbot-announcer": [f"LASERBOT_ARENA={announced}"],
    }
    image.write_text("webserver:1")
    engine = CardEngine()
    arrange(engine, found, image)
    assert {name: found["State"]["Status"] for name, found in engine.containers.items()} == {
        "laserbot-web": "running",
        "laserbot-announcer": "running",
    }


def test_the_first_start_loads_the_image_once_and_runs_all(image: Path) -> None:
    engine = CardEngine()
    arrange(engine, wanted(Card(camera="/dev/video0")), image)
    assert engine.changes.count("POST /images/load?quiet=1") == 1
    assert {name: found["State"]["Status"] for name, found in engine.containers.items()} == {
        "laserbot-robot": "running",
        "laserbot-camera": "running",
    }


def test_what_is_as_wanted_is_left_even_when_a_person_has_stopped_it(image: Path) -> None:
    engine = CardEngine()
    arrange(engine, wanted(), image)
    engine.containers["laserbot-robot"]["State"]["Status"] = "exited"
    engine.changes.clear()
    arrange(engine, wanted(), image)
    assert not engine.changes


def test_a_start_that_was_cut_off_is_done_again(image: Path) -> None:
    engine = CardEngine()
    arrange(engine, wanted(), image)
    engine.containers["laserbot-robot"]["State"]["Status"] = "created"
    arrange(engine, wanted(), image)
    assert engine.containers["laserbot-robot"]["State"]["Status"] == "running"


def test_another_laserbot_txt_makes_other_containers(image: Path) -> None:
    engine = CardEngine()
    arrange(engine, wanted(Card(camera="/dev/video0")), image)
    arrange(engine, wanted(Card(arena="hall"), "r2"), image)
    [(name, robot)] = engine.containers.items()
    assert name == "laserbot-robot"
    assert {"LASERBOT_ARENA=hall", "LASERBOT_ROBOT_NAME=r2"} <= set(robot["Config"]["Env"])


def test_a_container_that_is_not_wanted_any_more_goes(image: Path) -> None:
    engine = CardEngine()
    arrange(engine, {**wanted(), "laserbot-of-another-version": wanted()["laserbot-robot"]}, image)
    arrange(engine, wanted(), image)
    assert list(engine.containers) == ["laserbot-robot"]


def test_what_ansible_has_deployed_stays(image: Path) -> None:
    engine = CardEngine()
    engine.containers = {"laserbot-robot": {"Config": {"Labels": None}, "State": {"Status": "exited"}}}
    arrange(engine, wanted(), image)
    assert not engine.changes


def test_what_the_engine_refuses_is_told(image: Path) -> None:
    image.write_text("another:1")
    with pytest.raises(EngineError, match=r"POST /containers/create.*no such image"):
        arrange(CardEngine(), wanted(), image)


def test_an_image_that_cannot_be_read_is_told(image: Path) -> None:
    image.unlink()
    with pytest.raises(ValueError, match=r"image\.tar cannot be read: No such file"):
        arrange(CardEngine(), wanted(), image)


def test_an_image_that_the_engine_finds_to_be_broken_too_late_is_told(image: Path) -> None:
    engine = CardEngine()
    engine.torn.add("rosberry:1")
    with pytest.raises(EngineError, match=r"cannot load image\.tar: .*unexpected EOF"):
        arrange(engine, wanted(), image)


def test_the_old_container_runs_until_the_new_image_is_there(image: Path) -> None:
    engine = CardEngine()
    arrange(engine, wanted(), image)
    engine.images.clear()
    engine.changes.clear()
    arrange(engine, wanted(Card(arena="hall")), image)
    assert engine.changes == [
        "POST /images/load?quiet=1",
        "DELETE /containers/laserbot-robot?force=1",
        "POST /containers/create?name=laserbot-robot",
        "POST /containers/laserbot-robot/start",
    ]
