"""What the demo tells those who are to play from other computers and phones."""

import io
import sys

import pytest

from laser_bot_battle import addresses
from laser_bot_battle.interfaces import LanAddress
from laser_bot_battle.settings import SettingsError
from laser_bot_battle.variables import SHORTEST_TOKEN
from sim import demo_settings
from sim.demo import desk, from_the_network
from sim.demo_settings import Settings
from tests.support.programs import ROOT

PORTS = {"LASERBOT_WEB_PORT": 5000}


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture(autouse=True)
def network(monkeypatch: pytest.MonkeyPatch) -> None:
    found = [LanAddress(ip, 24) for ip in ("192.168.178.123", "10.9.0.1")]
    monkeypatch.setattr(addresses, "lan_addresses", lambda: found)


def test_a_demo_for_this_machine_only_says_nothing() -> None:
    assert from_the_network(Settings("127.0.0.1", PORTS)) == ""


def test_the_operators_desk_comes_with_a_token_of_its_own_or_with_yours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(demo_settings, "_trouble", lambda *_: "")
    tokens = {Settings.from_env({}).new_token for _ in range(3)}
    assert len(tokens) == 3
    assert min(map(len, tokens)) >= SHORTEST_TOKEN
    assert (
        desk(Settings("127.0.0.1", PORTS, "abc")) == "http://localhost:5000/operator   the operator's desk, token abc"
    )
    yours = Settings.from_env({"LASERBOT_OPERATOR_TOKEN": "one of your own choice"})
    assert desk(yours) == "http://localhost:5000/operator   the operator's desk, with your token"
    with pytest.raises(SettingsError, match="at least 16 characters"):
        Settings.from_env({"LASERBOT_OPERATOR_TOKEN": "mine"})


def test_a_demo_plays_with_coded_light_unless_the_environment_says_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(demo_settings, "_trouble", lambda *_: "")
    assert Settings.from_env({}).light == "coded"
    assert Settings.from_env({"LASERBOT_LIGHT": "plain"}).light == "plain"


def test_an_open_one_names_all_addresses() -> None:
    text = "In this network the game is at\n  http://192.168.178.123:5000   http://10.9.0.1:5000\n"
    assert from_the_network(Settings("0.0.0.0", PORTS)) == text


def test_a_terminal_shows_a_code_for_phones_that_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", Terminal())
    lines = from_the_network(Settings("0.0.0.0", PORTS)).splitlines()
    code = lines[2:]
    assert len(code) > 10
    assert {len(line) for line in code} == {29}
    assert set("".join(code)) == set(" ▀▄█")


def test_a_floors_file_is_found_by_all_parts_wherever_they_start(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(demo_settings, "_trouble", lambda *_: "")
    monkeypatch.chdir(ROOT)
    assert Settings.from_env({"LASERBOT_FLOOR": "Duel"}).floor == "Duel"
    assert Settings.from_env({"LASERBOT_FLOOR": "floors/hall.json"}).floor == str(ROOT / "floors" / "hall.json")
    with pytest.raises(SettingsError, match="No such file"):
        Settings.from_env({"LASERBOT_FLOOR": "floors/gone.json"})
