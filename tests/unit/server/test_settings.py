"""The web server's settings are those of their variables; the limits of each are tested with its declaration."""

from pathlib import Path

import pytest

from laser_bot_battle.settings import SettingsError
from server.web.settings import Settings


def test_the_defaults_are_the_manuals() -> None:
    settings = Settings.from_env({"HOME": "/home/op"})
    assert (settings.program.bind, settings.program.port, settings.rosbridge_port) == ("0.0.0.0", 5000, 9090)
    assert settings.program.master_uri == "http://localhost:11311"
    assert settings.data.is_absolute()
    assert settings.data.parts[-3:] == (".local", "share", "laserbot")
    rules = settings.rules
    assert (rules.hit_damage, rules.countdown, rules.battle_limit, rules.player_timeout) == (10, 15, 300, 15)


def test_players_practise_unless_they_must_not() -> None:
    assert Settings.from_env({}).rules.practice
    assert not Settings.from_env({"LASERBOT_PRACTICE": "0"}).rules.practice


def test_every_variable_is_read() -> None:
    settings = Settings.from_env(
        {
            "LASERBOT_BIND": "127.0.0.1",
            "LASERBOT_WEB_PORT": "80",
            "LASERBOT_ROSBRIDGE_PORT": "91",
            "LASERBOT_RELAY_PORT": "92",
            "LASERBOT_HIT_DAMAGE": "25",
            "LASERBOT_COUNTDOWN": "0.5",
            "LASERBOT_BATTLE_LIMIT": "60",
            "LASERBOT_PLAYER_TIMEOUT": "30",
            "LASERBOT_SEATS": "4",
            "LASERBOT_OPERATOR_TOKEN": "the operators' token",
            "LASERBOT_DATA": "/data",
            "LASERBOT_ROSTER": "pi=3",
            "LASERBOT_LOG_LEVEL": "DEBUG",
            "ROS_MASTER_URI": "http://master:1",
        }
    )
    program, rules = settings.program, settings.rules
    assert (program.bind, program.port, program.log_level, program.master_uri) == (
        "127.0.0.1",
        80,
        "debug",
        "http://master:1",
    )
    assert (settings.rosbridge_port, settings.relay_port) == (91, 92)
    assert (settings.data, settings.roster) == (Path("/data"), {"/id_service_client_pi": 3})
    assert (rules.hit_damage, rules.countdown, rules.battle_limit, rules.player_timeout) == (25, 0.5, 60, 30)
    assert (rules.seats, settings.operator_token) == (4, "the operators' token")


def test_the_operators_token_comes_from_a_file_too(tmp_path: Path) -> None:
    (tmp_path / "token").write_text("the token of a file\n")
    settings = Settings.from_env({"LASERBOT_OPERATOR_TOKEN_FILE": str(tmp_path / "token")})
    assert settings.operator_token == "the token of a file"
    assert Settings.from_env({}).operator_token == ""


def test_the_database_is_a_file_or_postgresql() -> None:
    def of(address: str) -> str:
        settings = Settings.from_env({"LASERBOT_DATA": "/data", "LASERBOT_DATABASE": address})
        return settings.database.render_as_string(hide_password=False)

    assert of("") == "sqlite:////data/laserbot.db"
    assert of("sqlite:////elsewhere/game.db") == "sqlite:////elsewhere/game.db"
    assert of("postgresql://op:secret@db/game") == "postgresql+pg8000://op:secret@db/game"
    assert of("postgresql://op@/game?unix_sock=/run/s") == "postgresql+pg8000://op@/game?unix_sock=%2Frun%2Fs"


@pytest.mark.parametrize(
    "address",
    [
        "game.db",
        "mysql://op:secret@db/game",
        "postgresql+psycopg2://op:secret@db/game",
        "postgresql://op:secret@db/x?a=b",
    ],
)
def test_another_database_is_refused_without_its_password(address: str) -> None:
    with pytest.raises(SettingsError, match="LASERBOT_DATABASE") as refused:
        Settings.from_env({"LASERBOT_DATABASE": address})
    assert "secret" not in str(refused.value)
