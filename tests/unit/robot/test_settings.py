import re
from pathlib import Path

import pytest

from laser_bot_battle.settings import SettingsError, shown
from robot.id_service_client import main
from robot.settings import Settings, default_robot_name
from tests.support.documents import Row, page, table
from tests.support.program_settings import Recorder


def test_the_defaults_are_those_of_the_manual() -> None:
    settings = Settings.from_env({})
    assert settings.place is None, "the robot finds the master"
    assert settings.arena == ""
    assert settings.devices == ("/dev/laserbot", "/dev/ttyACM0", "/dev/ttyUSB0")
    assert settings.retry == 5
    assert settings.led == 18
    assert settings.log_level == "info"
    assert settings.caller_id.startswith("/id_service_client_")


def test_the_environment_overrides_them() -> None:
    settings = Settings.from_env(
        {
            "LASERBOT_ARENA": "hall",
            "LASERBOT_MASTER": "10.0.0.7",
            "LASERBOT_WEB_PORT": "5050",
            "LASERBOT_SERIAL": "socket://arena:9000",
            "LASERBOT_ROBOT_NAME": "virtual-0",
            "LASERBOT_RETRY": "0.5",
            "LASERBOT_LED": "27",
            "LASERBOT_LOG_LEVEL": "DEBUG",
        }
    )
    assert settings.place
    assert (settings.place.host, settings.place.web) == ("10.0.0.7", 5050)
    assert settings.place.ros_master_uri == "http://10.0.0.7:11311"
    assert settings.arena == "hall"
    assert settings.devices == ("socket://arena:9000",)
    assert settings.caller_id == "/id_service_client_virtual_0"
    assert (settings.retry, settings.led, settings.log_level) == (0.5, 27, "debug")


@pytest.mark.parametrize("row", table(page("protocol-ros.md"), "Callers"), ids=lambda row: row["callerid"])
def test_a_robot_asks_for_its_id_by_the_name_on_the_protocols_page(row: Row) -> None:
    assert Settings.from_env({"LASERBOT_ROBOT_NAME": row["LASERBOT_ROBOT_NAME"]}).caller_id == row["callerid"]


def test_a_robot_may_have_no_led() -> None:
    assert Settings.from_env({"LASERBOT_LED": "none"}).led is None


def test_a_ros_master_that_is_set_counts() -> None:
    place = Settings.from_env({"ROS_MASTER_URI": "http://elsewhere:1"}).place
    assert place
    assert (place.host, place.ros_master_uri) == ("elsewhere", "http://elsewhere:1")


@pytest.mark.parametrize(
    ("variable", "value"),
    [
        ("LASERBOT_WEB_PORT", "http"),
        ("LASERBOT_WEB_PORT", "0"),
        ("LASERBOT_WEB_PORT", "65536"),
        ("LASERBOT_WEB_PORT", "5000.5"),
        ("LASERBOT_RETRY", "-1"),
        ("LASERBOT_RETRY", "nan"),
        ("LASERBOT_LED", "28"),
        ("LASERBOT_LED", "GPIO18"),
        ("LASERBOT_LED", "²"),
        ("LASERBOT_LOG_LEVEL", "loud"),
        ("LASERBOT_ARENA", "ha\nll"),
        ("LASERBOT_ARENA", "ä" * 32),
        ("ROS_MASTER_URI", "master"),
        ("ROS_MASTER_URI", "http://master"),
        ("ROS_MASTER_URI", "http://master:port"),
    ],
)
def test_a_value_that_cannot_be_used_is_named(variable: str, value: str) -> None:
    with pytest.raises(SettingsError, match=re.escape(f"{variable}={shown(value)}")):
        Settings.from_env({variable: value})


def test_the_help_lists_all_that_is_read(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    read = Recorder({})
    Settings.from_env(read)
    monkeypatch.setattr("sys.argv", ["robot.id_service_client", "--help"])
    with pytest.raises(SystemExit):
        main()
    assert read.read <= set(capsys.readouterr().out.split())


def interface(folder: Path, name: str, address: str, hardware: bool) -> None:
    (folder / name).mkdir()
    (folder / name / "address").write_text(address + "\n")
    if hardware:
        (folder / name / "device").mkdir()


def test_a_robots_own_name_has_the_address_of_its_first_network_hardware(tmp_path: Path) -> None:
    interface(tmp_path, "docker0", "02:42:00:00:00:01", hardware=False)
    interface(tmp_path, "lo", "00:00:00:00:00:00", hardware=False)
    interface(tmp_path, "wlan0", "b8:27:eb:00:00:02", hardware=True)
    interface(tmp_path, "eth0", "b8:27:eb:00:00:01", hardware=True)
    assert default_robot_name(tmp_path).endswith("_b8:27:eb:00:00:01")


def test_without_hardware_any_address_will_do_and_without_one_the_host_name(tmp_path: Path) -> None:
    host_name = default_robot_name(tmp_path)
    assert ":" not in host_name
    interface(tmp_path, "eth0", "02:42:00:00:00:01", hardware=False)
    assert default_robot_name(tmp_path) == host_name + "_02:42:00:00:00:01"


def test_several_serial_devices_are_looked_for_best_first() -> None:
    settings = Settings.from_env({"LASERBOT_SERIAL": "/host/dev/laserbot /host/dev/ttyACM0"})
    assert settings.devices == ("/host/dev/laserbot", "/host/dev/ttyACM0")
