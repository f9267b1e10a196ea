"""Settings of all programs: declared once; defaults, values, and one clear line for an impossible one."""

from pathlib import Path

import pytest

from laser_bot_battle import variables
from laser_bot_battle.settings import SettingsError, describe, read_or_exit, tidy

BY_NAME = {variable.name: variable for variable in (*variables.LASERBOT, variables.ROS_MASTER_URI)}


def test_an_unset_or_empty_variable_means_the_default() -> None:
    for environ in ({}, dict.fromkeys(BY_NAME, "")):
        assert variables.BIND.read(environ) == "0.0.0.0"
        assert variables.WEB.read(environ) == 5000
        assert variables.WEB.read(environ, 80) == 80
        assert variables.LED.read(environ) == 18
        assert variables.LOG_LEVEL.read(environ) == "info"
        assert variables.SERIAL.read(environ) == ("/dev/laserbot", "/dev/ttyACM0", "/dev/ttyUSB0")


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("LASERBOT_WEB_PORT", "80", 80),
        ("LASERBOT_COUNTDOWN", "0.5", 0.5),
        ("LASERBOT_DATA", "/data", Path("/data")),
        ("LASERBOT_LED", "none", None),
        ("LASERBOT_LED", "27", 27),
        ("LASERBOT_LOG_LEVEL", "DEBUG", "debug"),
        ("LASERBOT_SERIAL", "/host/dev/laserbot socket://arena:9000", ("/host/dev/laserbot", "socket://arena:9000")),
        ("ROS_MASTER_URI", "http://master:1", "http://master:1"),
        ("LASERBOT_ROSTER", " ", {}),
        (
            "LASERBOT_ROSTER",
            " raspberrypi1=1, virtual-0=0\n",
            {"/id_service_client_raspberrypi1": 1, "/id_service_client_virtual_0": 0},
        ),
    ],
)
def test_a_value_is_read(name: str, text: str, value: object) -> None:
    assert BY_NAME[name].read({name: text}) == value


@pytest.mark.parametrize(
    ("name", "text", "allowed"),
    [
        *[
            ("LASERBOT_WEB_PORT", text, "a whole number from 1 to 65535")
            for text in ("x", "0", "65536", "80.5", "٣", "5_000")
        ],
        ("LASERBOT_ROSBRIDGE_PORT", "-1", "a whole number from 1 to 65535"),
        *[("LASERBOT_HIT_DAMAGE", text, "a whole number from 1 to 100") for text in ("0", "101", "2.5")],
        *[("LASERBOT_COUNTDOWN", text, "a number from 0.1 to 3600") for text in ("nan", "inf", "soon", "٣", "1_0")],
        ("LASERBOT_BATTLE_LIMIT", "-5", "a number from 1 to 86400"),
        ("LASERBOT_RETRY", "-1", "a number from 0.1 to 3600"),
        *[("LASERBOT_LED", text, "a GPIO from 0 to 27, or none") for text in ("28", "GPIO18", "²")],
        *[
            ("LASERBOT_LOG_LEVEL", text, "one of debug, info, warning, error")
            for text in ("loud", "critical", "notset")
        ],
        *[
            ("ROS_MASTER_URI", text, "http://host:port")
            for text in ("master", "http://master", "http://master:port", "http://m:0", "http://m:70000", "http://m:٣")
        ],
    ],
)
def test_an_impossible_value_is_named_with_what_is_allowed(name: str, text: str, allowed: str) -> None:
    with pytest.raises(SettingsError) as error:
        BY_NAME[name].read({name: text})
    assert str(error.value) == f"{name}={text}: must be {allowed}"


@pytest.mark.parametrize(
    "text", ["a", "a=", "=1", "a=128", "a=-1", "a=1.5", "a=1 a=2", "a=1 b=1", "a-b=1 a_b=2", "a=x"]
)
def test_a_wrong_roster_is_named(text: str) -> None:
    with pytest.raises(SettingsError, match=r"^LASERBOT_ROSTER=.*(is not name=ID|repeats a name or an ID)"):
        variables.ROSTER.read({"LASERBOT_ROSTER": text})


def test_help_has_a_line_for_each_variable_without_markup() -> None:
    assert describe(variables.WEB, variables.LED).splitlines() == [
        "environment variables:",
        "  LASERBOT_WEB_PORT  the game's pages (default: 5000)",
        "  LASERBOT_LED       GPIO of a robot's status LED, or none (default: 18)",
    ]


def test_a_wrong_value_ends_a_program_with_one_line_and_exit_code_2(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("LASERBOT_WEB_PORT", "x")
    with pytest.raises(SystemExit) as end:
        read_or_exit("the.program", variables.WEB.read)
    assert end.value.code == 2
    assert capsys.readouterr().err == "the.program: LASERBOT_WEB_PORT=x: must be a whole number from 1 to 65535\n"


@pytest.mark.parametrize("text", ["80\r", "\ufeff80", " 80\n", "\u200b80\u00a0"])
def test_what_nobody_sees_around_a_value_is_left_out_and_told(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    environ = {"LASERBOT_WEB_PORT": text}
    assert variables.WEB.read(environ) == 80
    tidy("program", environ)
    assert environ == {"LASERBOT_WEB_PORT": "80"}
    told = capsys.readouterr().err
    assert told.startswith("program: LASERBOT_WEB_PORT=")
    assert told.rstrip("\n").isprintable()
    tidy("child", environ)
    assert capsys.readouterr().err == ""


def test_what_nobody_sees_within_a_value_is_shown() -> None:
    with pytest.raises(SettingsError) as error:
        variables.WEB.read({"LASERBOT_WEB_PORT": "8\u200b0"})
    assert "LASERBOT_WEB_PORT=8\\u200b0: " in str(error.value)


def test_a_setting_that_there_is_not_is_told_with_the_nearest_once(capsys: pytest.CaptureFixture[str]) -> None:
    service = {f"LASERBOT_MASTER_{name}": "10.0.0.1" for name in ("SERVICE_HOST", "PORT", "PORT_80_TCP_ADDR")}
    environ = {"LASERBOT_BATLE_LIMIT": "60", "LASERBOT_WEBB_PORT": "", "OTHER": "x", **service}
    tidy("program", environ)
    assert environ == {"OTHER": "x", **service}
    first, second = capsys.readouterr().err.splitlines()
    assert first == "program: LASERBOT_BATLE_LIMIT: there is no such setting; the nearest is LASERBOT_BATTLE_LIMIT"
    assert second.endswith("LASERBOT_WEBB_PORT: there is no such setting; the nearest is LASERBOT_WEB_PORT")
    tidy("child", environ)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("ROS_IP", "10.0.0.1 10.0.0.2"),
        ("ROS_IP", "raspberrypi1.local"),
        ("ROS_HOSTNAME", "http://master"),
        ("ROS_HOSTNAME", "two names"),
    ],
)
def test_an_address_that_ros_cannot_use_is_named(name: str, text: str) -> None:
    with pytest.raises(SettingsError, match=f"{name}={text}: must be"):
        tidy("program", {name: text})


def test_addresses_that_ros_can_use_stay() -> None:
    environ = {"ROS_IP": "", "ROS_HOSTNAME": "raspberrypi1.local"}
    for own in ("10.0.0.1", "fe80::1", ""):
        tidy("program", {**environ, "ROS_IP": own})
