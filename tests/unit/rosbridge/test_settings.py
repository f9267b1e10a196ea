"""rosbridge's settings."""

from pathlib import Path

import pytest

from laser_bot_battle.settings import SettingsError
from server.rosbridge.settings import Settings


def test_the_operators_token_comes_from_the_environment_or_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "token"
    file.write_text("of-a-file\n")
    assert Settings.from_env({}).operator_token == ""
    assert Settings.from_env({"LASERBOT_OPERATOR_TOKEN": "direct"}).operator_token == "direct"
    assert Settings.from_env({"LASERBOT_OPERATOR_TOKEN_FILE": str(file)}).operator_token == "of-a-file"


def test_an_empty_token_file_means_no_operator(tmp_path: Path) -> None:
    (tmp_path / "token").touch()
    assert Settings.from_env({"LASERBOT_OPERATOR_TOKEN_FILE": str(tmp_path / "token")}).operator_token == ""


def test_a_token_file_that_cannot_be_read_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"LASERBOT_OPERATOR_TOKEN_FILE=.*missing"):
        Settings.from_env({"LASERBOT_OPERATOR_TOKEN_FILE": str(tmp_path / "missing")})


def test_two_tokens_are_one_too_many(tmp_path: Path) -> None:
    (tmp_path / "token").write_text("one")
    both = {"LASERBOT_OPERATOR_TOKEN": "two", "LASERBOT_OPERATOR_TOKEN_FILE": str(tmp_path / "token")}
    with pytest.raises(SettingsError, match="both set"):
        Settings.from_env(both)
