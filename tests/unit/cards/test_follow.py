"""Robots' cards come to the version that their master runs, between two battles."""

import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

import pytest
from werkzeug.serving import make_server

from cards.archive import MANIFEST
from cards.follow import follow
from cards.laserbot_txt import Card
from cards.versions import State
from server.game.loop import GameLoop
from server.game.referee import HOLD, Referee
from server.game.rules import Rules
from server.web.settings import Settings
from tests.support.linked import add_linked_robot
from tests.support.ports import free_port
from tests.support.site import whole_site
from tests.support.updates import CardHost, Cut, image, power, write_update

ROBOT = Card(role="robot")


class Served(SimpleHTTPRequestHandler):
    """What the master's unit runs, with troubles on the way of the image."""

    trouble = ""
    over: threading.Event
    asked: ClassVar[list[str]]

    def copyfile(self, source: Any, outputfile: Any) -> None:
        self.asked.append(self.path)
        content = source.read()
        if self.path.endswith("image.tar"):
            if self.trouble in ("short", "slow"):
                content = content[: len(content) // 2]
            if self.trouble == "other":
                content = content[::-1]
        outputfile.write(content)
        if self.path.endswith("image.tar") and self.trouble == "slow":
            self.over.wait()

    def log_message(self, *_: Any) -> None:
        pass


class Hall:
    """A master's card, its server of versions and its game's, and a robot's card."""

    def __init__(self, folder: Path) -> None:
        self.master = CardHost(folder / "master", "master")
        self.robot = CardHost(folder / "robot", "robot")

        class Handler(Served):
            over = threading.Event()
            asked: ClassVar[list[str]] = []

        self.handler = Handler
        self.now = 0.0
        self.game = GameLoop(Referee(Rules(countdown=1)), clock=lambda: self.now)
        served = ThreadingHTTPServer(("127.0.0.1", 0), partial(self.handler, directory=self.master.store.served))
        served.daemon_threads = False
        game = make_server("127.0.0.1", free_port(), whole_site(self.game, Settings.from_env({})))
        self.served_at = f"http://127.0.0.1:{served.server_address[1]}"
        self.game_at = f"http://127.0.0.1:{game.server_port}"
        self._servers = (served, game)
        self._threads = [threading.Thread(target=server.serve_forever, args=(0.05,)) for server in self._servers]
        for thread in self._threads:
            thread.start()

    def end(self) -> None:
        self.handler.over.set()
        for server, thread in zip(self._servers, self._threads, strict=True):
            server.shutdown()
            thread.join()
            server.server_close()

    def serve(self, version: str, **settings: Any) -> None:
        write_update(self.master.boot / f"{version}.update", version)
        self.master.start(**settings)

    def minute(self, card: Card = ROBOT, robot: CardHost | None = None, **places: str) -> None:
        """The robot's timer."""
        robot = robot or self.robot
        places = {"served_at": self.served_at, "game_at": self.game_at, **places}
        follow(robot.store, card, "host", robot.engine, **places, restart=partial(robot.settle, card))

    def battle(self) -> None:
        self.now += HOLD  # for which no countdown begins after a question from this machine
        for number, name in enumerate(("al", "bo")):
            add_linked_robot(self.game, f"/id_service_client_{name}")
            self.game.sign_up(name, name, 0)
            assert self.game.snapshot().robots[-1] == number
            self.game.set_ready(name, True, name)
        self.now += 2  # the countdown

    def end_battle(self) -> None:
        self.now += 1000  # its time limit


@pytest.fixture
def hall(tmp_path: Path) -> Iterator[Hall]:
    hall = Hall(tmp_path)
    hall.master.start()
    hall.robot.start()
    yield hall
    hall.end()


def test_a_robot_stays_as_it_is_while_the_master_runs_the_same(hall: Hall) -> None:
    hall.robot.engine.changes.clear()
    hall.minute()
    assert hall.handler.asked == [f"/{MANIFEST}"]
    assert not hall.robot.engine.changes
    hall.serve("2")
    hall.minute()
    hall.handler.asked.clear()
    hall.minute()
    assert hall.handler.asked == [f"/{MANIFEST}"], "a minute costs one small question"


def test_a_robot_follows_its_master_to_a_new_version_and_back(hall: Hall) -> None:
    hall.serve("2")
    hall.minute()
    assert (hall.robot.runs, hall.robot.store.state()) == ("2", State("2", "1"))
    hall.serve("3")
    hall.minute()
    assert hall.robot.store.stored() == {"2", "3"}
    assert hall.robot.engine.images == {image("robot", "2"), image("robot", "3")}
    hall.handler.asked.clear()
    for settings, version in (({"version": "previous"}, "2"), ({}, "3")):
        hall.master.start(**settings)
        hall.minute()
        assert (hall.master.runs, hall.robot.runs) == (version, version)
    assert set(hall.handler.asked) == {f"/{MANIFEST}"}, "both are stored"


def test_a_robot_goes_back_to_its_own_version_with_a_master_that_has_nothing_else(hall: Hall) -> None:
    hall.serve("2")
    hall.minute()
    hall.master.start(version="previous")
    assert hall.master.serves.files == {}
    hall.minute()
    assert hall.robot.runs == "1"


def test_a_robot_that_does_not_run_with_a_version_goes_back_and_does_not_try_it_again(hall: Hall) -> None:
    hall.robot.engine.restless.add(image("robot", "2"))
    hall.serve("2")
    hall.minute()
    assert hall.robot.runs == "1"
    assert "version 2 does not run here" in hall.robot.told[0]
    hall.robot.engine.restless.clear()
    hall.handler.asked.clear()
    hall.minute()
    assert hall.robot.runs == "1"
    assert hall.handler.asked == [f"/{MANIFEST}"]
    hall.serve("3")
    hall.minute()
    assert hall.robot.runs == "3"


def test_a_robot_whose_master_or_arduino_is_away_during_the_trial_keeps_the_new_version(hall: Hall) -> None:
    hall.robot.engine.ill.add(image("robot", "2"))
    hall.serve("2")
    hall.minute()
    assert (hall.robot.runs, hall.robot.store.state()) == ("2", State("2", "1"))


@pytest.mark.parametrize("trouble", ["short", "slow", "other"])
def test_what_does_not_arrive_whole_is_got_again_a_minute_later(
    trouble: str, hall: Hall, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cards.follow.TIMEOUT", 0.3)
    hall.serve("2")
    hall.handler.trouble = trouble
    hall.minute()
    assert hall.robot.runs == "1"
    assert hall.robot.store.stored() == set()
    hall.handler.trouble = ""
    monkeypatch.undo()
    hall.minute()
    assert hall.robot.runs == "2"


def test_without_a_master_nothing_happens(hall: Hall) -> None:
    hall.robot.engine.changes.clear()
    hall.minute(served_at=f"http://127.0.0.1:{free_port()}")
    hall.minute(served_at=hall.game_at)  # another server
    (hall.master.store.served / MANIFEST).write_text('{"format": 2}')
    hall.minute()
    assert not hall.robot.engine.changes


def test_during_a_battle_nothing_happens(hall: Hall) -> None:
    hall.serve("2")
    hall.battle()
    hall.minute()
    assert hall.robot.runs == "1"
    assert hall.handler.asked == [f"/{MANIFEST}"]
    hall.end_battle()
    hall.minute()
    assert hall.robot.runs == "2"


def test_a_game_that_does_not_answer_may_have_a_battle(hall: Hall) -> None:
    hall.serve("2")
    hall.minute(game_at=f"http://127.0.0.1:{free_port()}")
    assert hall.robot.runs == "1"


def test_a_battle_that_begins_meanwhile_is_waited_for(hall: Hall, monkeypatch: pytest.MonkeyPatch) -> None:
    hall.serve("2")
    copyfile = Served.copyfile

    def begin(handler: Served, source: Any, outputfile: Any) -> None:
        if handler.path.endswith("image.tar"):
            hall.battle()
        copyfile(handler, source, outputfile)

    monkeypatch.setattr(hall.handler, "copyfile", begin, raising=False)
    hall.minute()
    assert (hall.robot.runs, hall.robot.store.stored()) == ("1", {"2"})
    assert image("robot", "2") not in hall.robot.engine.images
    monkeypatch.undo()
    hall.minute()
    assert hall.robot.runs == "1"
    hall.end_battle()
    hall.handler.asked.clear()
    hall.minute()
    assert hall.robot.runs == "2"
    assert hall.handler.asked == [f"/{MANIFEST}"], "it has been got already"


def test_the_image_is_loaded_while_the_robot_still_plays(hall: Hall, monkeypatch: pytest.MonkeyPatch) -> None:
    hall.serve("2")
    monkeypatch.setattr(hall.robot, "settle", lambda card: None)
    hall.minute()
    assert image("robot", "2") in hall.robot.engine.images
    assert hall.robot.runs == "1"


@pytest.mark.parametrize("arena, version", [("hall", "2"), ("HALL", "2"), ("yard", "1"), (None, "2")])
def test_a_robot_follows_only_the_master_of_its_arena(arena: str | None, version: str, hall: Hall) -> None:
    hall.serve("2", arena="hall")
    hall.minute(Card(role="robot", arena=arena))
    assert hall.robot.runs == version


def test_a_robot_that_ansible_has_deployed_is_left_alone(hall: Hall) -> None:
    hall.serve("2")
    [robot] = hall.robot.engine.containers.values()
    robot["Config"] = {**robot["Config"], "Labels": {"laserbot.made-from": "x"}}
    hall.minute()
    assert hall.robot.runs == "1"
    assert not hall.handler.asked


def test_the_power_may_go_at_any_step(hall: Hall, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for version in "23":
        hall.serve(version)
        hall.minute()
    hall.serve("4")
    for steps in count():
        robot = hall.robot.copy(tmp_path / str(steps))
        is_cut = False
        try:
            with power(steps, robot.engine, monkeypatch):
                hall.minute(robot=robot)
        except Cut:
            is_cut = True
        state = robot.store.state()
        assert state.current in robot.store.stored()
        robot.start()
        hall.minute(robot=robot)
        assert (robot.runs, robot.store.state(), robot.store.stored()) == ("4", State("4", "3"), {"3", "4"})
        # after a cut while the image was loaded, it is the only one: the other is loaded when it is needed
        assert robot.engine.images in ({image("robot", "3"), image("robot", "4")}, {image("robot", "4")})
        assert not robot.engine.hollow & robot.engine.images
        if not is_cut:
            break
    assert steps > 25
