"""Bots that were told no address."""

import re
from pathlib import Path

import pytest

from tests.integration.discovery.master import NOTHING_GIVEN, LanMaster
from tests.integration.discovery.robot import LanRobot
from tests.support.lan import Lan, needs_root
from tests.support.polling import until

pytestmark = needs_root


@pytest.mark.slow
def test_a_bot_finds_the_master_and_follows_it_to_another_address(lan: Lan, tmp_path: Path) -> None:
    home, away = lan.machine(), lan.machine()
    bot = lan.machine().python("server.bots", env=NOTHING_GIVEN)
    bot.wait_for("no arena announces itself in this network: start it, or set LASERBOT_MASTER to its address; waiting")
    with LanMaster(home, "hall", tmp_path) as master, LanRobot(away, tmp_path):
        bot.wait_for("arena 'hall' at 10.9.0.1, announced")
        bot.wait_for("signed up as Bot1, driving robot 0")
        bot.wait_for("no rosbridge at ws://10.9.0.1:9090; waiting")
        home.set_address(7)
        bot.wait_for("the server is gone: looking for arena 'hall' at another address")
        bot.wait_for("arena 'hall' at 10.9.0.7, announced")
        until(lambda: len(re.findall(r"signed up as Bot\d+, driving robot 0", bot.output)) == 2)
        bot.wait_for("no rosbridge at ws://10.9.0.7:9090; waiting")
        assert bot.stop() == 0
        until(lambda: master.robots() == 1, what="the bot has given the robot back")
    assert "Traceback" not in bot.output


@pytest.mark.slow
def test_a_bot_that_was_given_an_address_stays_there(lan: Lan, tmp_path: Path) -> None:
    bot = lan.machine().python("server.bots", env={**NOTHING_GIVEN, "LASERBOT_MASTER": "10.9.0.9"})
    with LanMaster(lan.machine(), "hall", tmp_path):
        bot.wait_for("master at 10.9.0.9, as LASERBOT_MASTER says")
        bot.wait_for("no game server at http://10.9.0.9:5000")
        assert bot.stop() == 0
    assert "hall" not in bot.output
