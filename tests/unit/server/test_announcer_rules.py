"""What the announcer is told, and to whom it yields."""

import socket
from unittest.mock import patch

import pytest
from zeroconf import DNSAddress, DNSText

from laser_bot_battle.settings import SettingsError
from server.announcer.host_names import stronger
from server.announcer.settings import Settings, host_arena

A, AAAA, TEXT, INTERNET = 1, 28, 16, 1
HERE = ["10.9.0.5", "192.168.1.5"]


def address(text: str) -> DNSAddress:
    family = socket.AF_INET6 if ":" in text else socket.AF_INET
    return DNSAddress("host.local.", AAAA if ":" in text else A, INTERNET, 120, socket.inet_pton(family, text))


def test_every_variable_is_read() -> None:
    settings = Settings.from_env(
        {
            "LASERBOT_ARENA": " Halle 1 ",
            "LASERBOT_BIND": "10.9.0.1",
            "LASERBOT_WEB_PORT": "80",
            "LASERBOT_ROSBRIDGE_PORT": "91",
            "LASERBOT_LOG_LEVEL": "DEBUG",
            "ROS_MASTER_URI": "http://localhost:92/",
        }
    )
    assert settings == Settings("Halle 1", "10.9.0.1", 80, 91, 92, "debug")


@pytest.mark.parametrize(
    ("host", "arena"),
    [
        ("laser-bot-master", "laser-bot-master"),
        ("master.lan", "master"),
        ("", "LaserBot"),
        ("ä" * 40, "ä" * 30),
    ],
)
def test_without_a_name_the_arena_is_called_as_its_host(host: str, arena: str) -> None:
    assert host_arena(host) == arena
    with patch("socket.gethostname", lambda: host):
        assert Settings.from_env({}).arena == arena


@pytest.mark.parametrize("name", ["hall.1", "x" * 61, "ä" * 31, "hall\n1", "\x1b[2J", "_sub"])
def test_a_name_that_cannot_be_announced_is_refused(name: str) -> None:
    with pytest.raises(SettingsError, match="must be a name of at most 60 bytes without dots"):
        Settings.from_env({"LASERBOT_ARENA": name})


def test_a_host_name_is_left_to_a_machine_above_all_own_addresses() -> None:
    assert stronger(address("192.168.1.6"), HERE) == "192.168.1.6"
    assert stronger(address("10.9.0.6"), HERE) is None
    assert stronger(address("192.168.1.5"), HERE) is None


def test_other_addresses_of_this_machine_and_other_records_are_no_rival() -> None:
    with patch("server.announcer.host_names.own_addresses", lambda: {"192.168.9.9"}):
        assert stronger(address("192.168.9.9"), HERE) is None
    assert stronger(address("fe80::1"), HERE) is None
    assert stronger(DNSText("host.local.", TEXT, INTERNET, 120, b""), HERE) is None
