"""The web server's settings are those of their variables; the limits of each are tested with its declaration."""

from pathlib import Path

from server.settings import Settings


def test_the_defaults_are_the_manuals() -> None:
    settings = Settings.from_env({"HOME": "/home/op"})
    assert (settings.node.bind, settings.node.port, settings.rosbridge_port) == ("0.0.0.0", 5000, 9090)
    assert settings.view_port is None
    assert settings.node.master_uri == "http://localhost:11311"
    assert settings.data.is_absolute()
    assert settings.data.parts[-3:] == (".local", "share", "laserbot")
    rules = settings.rules
    assert (rules.hit_damage, rules.countdown, rules.battle_limit, rules.player_timeout) == (10, 15, 300, 15)


def test_every_variable_is_read() -> None:
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
    node, rules = settings.node, settings.rules
    assert (node.bind, node.port, node.log_level, node.master_uri) == ("127.0.0.1", 80, "debug", "http://master:1")
    assert (settings.rosbridge_port, settings.view_port) == (91, 92)
    assert (settings.data, settings.roster) == (Path("/data"), {"/id_service_client_pi": 3})
    assert (rules.hit_damage, rules.countdown, rules.battle_limit, rules.player_timeout) == (25, 0.5, 60, 30)
