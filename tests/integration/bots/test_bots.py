"""Bots against a real server, rosbridge, arena and robots with the real firmware, as the operator gives them robots."""

from typing import Any

import pytest

from tests.support.demo import Demo
from tests.support.player import Player, players_and_free_robots
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program

PLAYING = 2


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=1)
    return demo


def drivers(battle: Demo) -> dict[str, int]:
    """The robots by their players' names; none while the server is away."""
    found = players_and_free_robots(battle)
    return dict(found[0]) if found else {}


def is_ready(watcher: Player, name: str) -> bool:
    return bool(watcher.user(name).get("ready"))


def test_a_visitor_and_a_bot_on_the_other_robot_have_a_battle(battle: Demo) -> None:
    battle.give_to_bot(0)
    battle.give_to_bot(1)
    until(lambda: drivers(battle) == {"Bot1": 0, "Bot2": 1} or drivers(battle) == {"Bot1": 1, "Bot2": 0}, 15)
    with Visitor(battle, "Ann") as ann:  # one of the bots makes room
        (bot,) = drivers(battle).keys() - {"Ann"}
        assert not is_ready(ann, bot)
        assert ann.ready() == "OK"
        until(lambda: is_ready(ann, bot), 5, "the bot is ready")
        ann.wait_for_game(PLAYING)
        until(lambda: ann.user()["life"] < 100, 60, "the bot hits")
        assert ann.user(bot)["life"] == 100
        battle.give_to_bot(drivers(battle)[bot], None)
        until(lambda: ann.look()["game"] == 0, 5, "the operator has taken the robot back: the battle is over")
        assert drivers(battle).keys() == {"Ann"}


class Visitor(Player):
    """Comes when there is no robot left, and takes the one that is offered at once."""

    def sign_up(self) -> dict[str, Any]:
        first = self.post("signUpUser", data=self.name, wait=1)
        assert (first["status"], first["place"]) == ("QUEUED", 1)
        assert first["offer"] is not None
        return self.post("takeRobot")


def test_it_takes_ready_back_with_the_human(battle: Demo) -> None:
    battle.give_to_bot(1)
    until(lambda: drivers(battle) == {"Bot1": 1}, 15)
    with Player(battle, "Ann") as ann:
        ann.ready(1)
        until(lambda: is_ready(ann, "Bot1"), 5, "the bot is ready")
        ann.ready(0)
        until(lambda: not is_ready(ann, "Bot1"), 5, "the bot is not ready")


def test_it_comes_when_the_robot_is_free_again(battle: Demo) -> None:
    with Player(battle, "Ann") as ann:
        battle.give_to_bot(ann.robot)
        waits = f"robot {ann.robot} is not free; waiting"
        before = battle.log.count(waits)
        until(lambda: battle.log.count(waits) > before, 10, "the bot waits")
    until(lambda: drivers(battle) == {"Bot1": ann.robot}, 10, "the bot has the robot")


def test_it_comes_back_after_a_restart_of_the_server_and_of_rosbridge(battle: Demo) -> None:
    connected, signed_up = "Bot1 is connected to rosbridge", "signed up as Bot1"
    before = [battle.log.count(words) for words in (connected, signed_up)]
    battle.give_to_bot(1)
    until(lambda: battle.log.count(connected) == before[0] + 1, 15, "it is connected")
    battle.kill("server.rosbridge")
    until(lambda: battle.log.count(connected) == before[0] + 2, 20, "connected again")
    battle.kill("server.main")  # the next one may be there before the bot misses it
    until(lambda: "Bot1" in drivers(battle), 30, "it is still signed in")
    with Player(battle, "Ann") as ann:
        ann.ready(1)
        until(lambda: is_ready(ann, "Bot1"), 10, "it plays with the next server")
        ann.ready(0)
    assert battle.log.count(signed_up) == before[1] + 1


def test_without_positions_it_is_not_ready_and_says_so(battle: Demo) -> None:
    """As on real robots without a camera above the floor: everything else plays on."""
    said = "/positions does not say where robot 1 is: Bot1 is waiting"
    battle.give_to_bot(1)
    with Player(battle, "Ann") as ann:
        with battle.pause("sim.positions"):
            until(lambda: said in battle.log, 10, "the bot sees nothing")
            ann.ready(1)
            assert not is_ready(ann, "Bot1")
        until(lambda: is_ready(ann, "Bot1"), 5, "it sees, and is ready")


def test_without_a_server_they_wait_and_end_cleanly() -> None:
    bots = Program.python("server.bots", "--master", "127.0.0.1", env={"LASERBOT_WEB_PORT": str(free_port())})
    bots.wait_for("no game server at")
    assert bots.stop() == 0
    assert "Traceback" not in bots.output


def test_an_impossible_setting_is_one_clear_line() -> None:
    bots = Program.python("server.bots", "--rosbridge", "master")
    assert bots.exit_code() == 2
    assert bots.output == "python3 -m server.bots: --rosbridge master: must be HOST:PORT\n"
