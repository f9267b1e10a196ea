"""The bot against a real server, rosbridge, arena and robots with the real firmware."""

import json
import signal
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import requests

from tests.support.demo import Demo
from tests.support.player import Player
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program

StartBot = Callable[..., Program]


@pytest.fixture
def battle(demo: Demo) -> Demo:
    demo.play_by(countdown=1)
    return demo


@pytest.fixture
def start_bot(battle: Demo) -> Iterator[StartBot]:
    """Starts a bot; every bot of a test has ended, and left no user behind, when the test ends."""
    bots = []

    def start(*arguments: str) -> Program:
        bot = Program.python("sim.bot", "--master", "127.0.0.1", *arguments, env=environment(battle))
        bots.append(bot)
        return bot

    yield start
    for bot in bots:
        if bot.running:
            assert bot.stop() == 0
        assert "Traceback" not in bot.output, bot.output
    until(lambda: not users(battle), 5, "bots signed out")


def environment(battle: Demo) -> dict[str, str]:
    return {
        "LASERBOT_WEB_PORT": str(battle.web_port),
        "LASERBOT_ROSBRIDGE_PORT": str(battle.rosbridge_port),
        "LASERBOT_ARENA_PORT": str(battle.arena_port),
    }


def users(battle: Demo) -> dict[str, dict[str, Any]]:
    """The signed-in users by name; none while the server is away."""
    try:
        reply = json.loads(requests.post(f"{battle.web}/updateGameStatus", data={"data": "data"}, timeout=5).text)
    except requests.RequestException:
        return {}
    return {user["name"]: user for user in json.loads(reply["users"])}


def is_ready(battle: Demo, name: str) -> bool:
    user = users(battle).get(name)
    return bool(user and user["ready"])


def test_it_hunts_a_ready_human_and_hits(battle: Demo, start_bot: StartBot) -> None:
    start_bot()
    until(lambda: "Bot1" in users(battle), 15)
    with Player(battle, "Ann") as ann:
        assert not is_ready(battle, "Bot1")
        assert ann.ready() == "OK"
        until(lambda: is_ready(battle, "Bot1"), 5, "the bot is ready")
        until(lambda: ann.look().get("game") == 2, 10, "the battle begins")
        until(lambda: users(battle)["Ann"]["life"] < 100, 60, "the bot hits")
        assert users(battle)["Bot1"]["life"] == 100


def test_it_takes_ready_back_with_the_human(battle: Demo, start_bot: StartBot) -> None:
    start_bot()
    until(lambda: "Bot1" in users(battle), 15)
    with Player(battle, "Ann") as ann:
        ann.ready(1)
        until(lambda: is_ready(battle, "Bot1"), 5, "the bot is ready")
        ann.ready(0)
        until(lambda: not is_ready(battle, "Bot1"), 5, "the bot is not ready")


def test_it_waits_for_a_robot(battle: Demo, start_bot: StartBot) -> None:
    with Player(battle, "Ann"):
        with Player(battle, "Cid"):
            bot = start_bot()
            bot.wait_for("no robot is free; waiting")
        bot.wait_for("signed up as Bot1")


def test_it_comes_back_after_a_restart_of_the_server_and_of_rosbridge(battle: Demo, start_bot: StartBot) -> None:
    bot = start_bot()
    bot.wait_for("connected to rosbridge")
    battle.kill("server.rosbridge")
    until(lambda: bot.output.count("connected to rosbridge") == 2, 20, "connected again")
    battle.kill("server.main")  # the next one may be there before the bot misses it
    until(lambda: "Bot1" in users(battle), 30, "it is still signed in")
    with Player(battle, "Ann") as ann:
        ann.ready(1)
        until(lambda: is_ready(battle, "Bot1"), 10, "it plays with the next server")
        ann.ready(0)
    assert bot.output.count("signed up as Bot1") == 1


@pytest.mark.parametrize("signum", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_makes_it_sign_out(battle: Demo, start_bot: StartBot, signum: signal.Signals) -> None:
    bot = start_bot("--name", "Bot7")
    bot.wait_for("signed up as Bot7")
    assert "Bot7" in users(battle)
    assert bot.stop(signum) == 0
    assert "Bot7" not in users(battle)


def test_without_a_server_it_waits_and_ends_cleanly() -> None:
    ports = {name: str(free_port()) for name in ("LASERBOT_WEB_PORT", "LASERBOT_ARENA_PORT")}
    bot = Program.python("sim.bot", "--master", "127.0.0.1", env=ports)
    bot.wait_for("no game server at")
    bot.wait_for(f"the arena at ws://127.0.0.1:{ports['LASERBOT_ARENA_PORT']}/view does not answer")
    assert bot.stop() == 0
    assert "Traceback" not in bot.output


def test_an_impossible_setting_is_one_clear_line() -> None:
    bot = Program.python("sim.bot", "--name", "Ann")
    assert bot.process.wait(10) == 2
    assert bot.output == "bot: --name Ann: must be Bot and a number of up to 13 digits\n"
