"""Settings from the environment: defaults, values, and one clear line for an impossible one."""

from pathlib import Path

import pytest

from server.settings import Settings, SettingsError


def test_defaults():
    settings = Settings.from_env({"HOME": "/home/op"})
    assert (settings.bind, settings.web_port, settings.rosbridge_port) == ("0.0.0.0", 5000, 9090)
    assert settings.view_port is None
    assert settings.master_uri == "http://localhost:11311"
    assert settings.data.parts[-3:] == (".local", "share", "laserbot")
    assert settings.data.is_absolute()
    rules = settings.rules
    assert (rules.hit_damage, rules.countdown, rules.battle_limit, rules.player_timeout) == (10, 15, 300, 15)


def test_every_variable_is_read():
    settings = Settings.from_env(
        {
            "LASERBOT_BIND": "127.0.0.1",
            "LASERBOT_WEB_PORT": "80",
            "LASERBOT_ROSBRIDGE_PORT": "91",
            "LASERBOT_VIEW_PORT": "92",
            "LASERBOT_HIT_DAMAGE": "25",
            "LASERBOT_COUNTDOWN": "0.5",
            "LASERBOT_BATTLE_LIMIT": "60",
            "LASERBOT_PLAYER_TIMEOUT": "30",
            "LASERBOT_DATA": "/data",
            "LASERBOT_ROSTER": "pi=3",
            "LASERBOT_LOG_LEVEL": "DEBUG",
            "ROS_MASTER_URI": "http://master:1",
        }
    )
    assert (settings.bind, settings.web_port, settings.rosbridge_port) == ("127.0.0.1", 80, 91)
    assert settings.view_port == 92
    assert settings.roster == {"/id_service_client_pi": 3}
    rules = settings.rules
    assert (rules.hit_damage, rules.countdown, rules.battle_limit, rules.player_timeout) == (25, 0.5, 60, 30)
    assert (settings.data, settings.log_level, settings.master_uri) == (Path("/data"), "debug", "http://master:1")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("LASERBOT_WEB_PORT", "x"),
        ("LASERBOT_WEB_PORT", "0"),
        ("LASERBOT_WEB_PORT", "65536"),
        ("LASERBOT_WEB_PORT", "80.5"),
        ("LASERBOT_ROSBRIDGE_PORT", "-1"),
        ("LASERBOT_VIEW_PORT", "0"),
        ("LASERBOT_HIT_DAMAGE", "0"),
        ("LASERBOT_HIT_DAMAGE", "101"),
        ("LASERBOT_HIT_DAMAGE", "2.5"),
        ("LASERBOT_COUNTDOWN", "nan"),
        ("LASERBOT_COUNTDOWN", "inf"),
        ("LASERBOT_BATTLE_LIMIT", "-5"),
        ("LASERBOT_PLAYER_TIMEOUT", "soon"),
        ("LASERBOT_LOG_LEVEL", "loud"),
    ],
)
def test_an_impossible_value_is_named(name, value):
    with pytest.raises(SettingsError, match=f"^{name}={value}: must be .*") as error:
        Settings.from_env({name: value})
    assert "\n" not in str(error.value)


def test_an_empty_variable_means_the_default():
    assert Settings.from_env({"LASERBOT_WEB_PORT": ""}).web_port == 5000


def test_a_wrong_roster_is_named():
    with pytest.raises(SettingsError, match=r"^LASERBOT_ROSTER=pi: 'pi' is not name=ID"):
        Settings.from_env({"LASERBOT_ROSTER": "pi"})
