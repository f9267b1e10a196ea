"""rosbridge's settings."""

from pathlib import Path

import pytest

from laser_bot_battle.settings import SettingsError
from server.rosbridge.settings import Settings


def test_the_operators_token_comes_from_the_environment_or_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "token"
    file.write_text("the-token-of-a-file\n")
    assert Settings.from_env({}).operator_token == ""
    assert Settings.from_env({"LASERBOT_OPERATOR_TOKEN": "x" * 16}).operator_token == "x" * 16
    assert Settings.from_env({"LASERBOT_OPERATOR_TOKEN_FILE": str(file)}).operator_token == "the-token-of-a-file"


def test_an_empty_token_file_means_no_operator(tmp_path: Path) -> None:
    (tmp_path / "token").touch()
    assert Settings.from_env({"LASERBOT_OPERATOR_TOKEN_FILE": str(tmp_path / "token")}).operator_token == ""


def test_a_token_file_that_cannot_be_read_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"LASERBOT_OPERATOR_TOKEN_FILE=.*missing"):
        Settings.from_env({"LASERBOT_OPERATOR_TOKEN_FILE": str(tmp_path / "missing")})


@pytest.mark.parametrize("token", ["of 15 character", "ö" * 15])
def test_a_token_that_could_be_guessed_is_refused_with_how_to_make_one(token: str, tmp_path: Path) -> None:
    (tmp_path / "token").write_text(f"{token}\n")
    for name, value in (
        ("LASERBOT_OPERATOR_TOKEN", token),
        ("LASERBOT_OPERATOR_TOKEN_FILE", str(tmp_path / "token")),
    ):
        with pytest.raises(
            SettingsError, match=rf"^{name}\b.* at least 16 characters.* openssl rand -hex 16$"
        ) as refused:
            Settings.from_env({name: value})
        assert token not in str(refused.value)


def test_two_tokens_are_one_too_many(tmp_path: Path) -> None:
    (tmp_path / "token").write_text("one")
    both = {"LASERBOT_OPERATOR_TOKEN": "two", "LASERBOT_OPERATOR_TOKEN_FILE": str(tmp_path / "token")}
    with pytest.raises(SettingsError, match="both set"):
        Settings.from_env(both)
