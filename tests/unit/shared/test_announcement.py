"""What an announcement may say, and which arena is chosen."""

import pytest

from laser_bot_battle.announcement import SERVICE, Announcement, NoArenaError, UnheardError, choose, read
from laser_bot_battle.names import VERSION

TEXT: dict[bytes, bytes | None] = {b"version": VERSION.encode(), b"rosbridge": b"9090", b"ros": b"11311"}


def arena(name: str) -> Announcement:
    return read(f"{name}.{SERVICE}", 5000, TEXT, ["10.0.0.1"])


def test_what_a_master_says_is_read() -> None:
    announcement = read(f"The hall.{SERVICE}", 5000, TEXT, ["10.0.0.1", "192.168.1.1"])
    assert announcement == Announcement("The hall", ("10.0.0.1", "192.168.1.1"), 5000, 9090, 11311, VERSION)
    assert {key.encode(): value.encode() for key, value in announcement.text().items()} == TEXT


def test_another_version_of_the_same_kind_is_understood() -> None:
    major = VERSION.partition(".")[0]
    text = {**TEXT, b"version": f"{major}.99.7".encode(), b"unknown": None}
    assert read(f"hall.{SERVICE}", 5000, text, ["10.0.0.1"]).version == f"{major}.99.7"


@pytest.mark.parametrize(
    ("key", "value", "reason"),
    [
        (b"version", b"99.0.0", "it is of version 99.0.0, and this program of"),
        (b"version", b"", "its version is missing"),
        (b"version", None, "its version is missing"),
        (b"version", b"1\x1b[2J", "its version is missing"),
        (b"version", b"1" * 33, "its version is missing"),
        (b"version", b"\xff\x00", "its version is missing"),
        (b"ros", None, "its ros is missing"),
        (b"ros", b"0", "its ROS port is not a port"),
        (b"ros", b"65536", "its ROS port is not a port"),
        (b"ros", b"-1", "its ROS port is not a port"),
        (b"ros", "٣".encode(), "its ROS port is not a port"),
        (b"rosbridge", b"9090; rm", "its rosbridge port is not a port"),
    ],
)
def test_a_record_that_is_no_good_is_refused_with_the_reason(key: bytes, value: bytes | None, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        read(f"hall.{SERVICE}", 5000, {**TEXT, key: value}, ["10.0.0.1"])


@pytest.mark.parametrize("port", [None, 0, -1, 65536])
def test_a_web_port_must_be_one(port: int | None) -> None:
    with pytest.raises(ValueError, match="its web port is not a port"):
        read(f"hall.{SERVICE}", port, TEXT, ["10.0.0.1"])


@pytest.mark.parametrize("name", ["", "a\nb", "\x1b[2J", "a" * 64, "ä" * 32, "\u202e"])
def test_a_name_that_could_not_be_an_arenas_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="its name is not one of an arena"):
        arena(name)


def test_only_addresses_of_hosts_count_and_not_too_many() -> None:
    useless = ["127.0.0.1", "0.0.0.0", "224.0.0.251", "255.255.255.255", "fd00::1", "nonsense"]
    with pytest.raises(ValueError, match="it names no address"):
        read(f"hall.{SERVICE}", 5000, TEXT, useless)
    many = [f"10.0.0.{number}" for number in range(1, 100)]
    assert read(f"hall.{SERVICE}", 5000, TEXT, [*useless, *many]).addresses == tuple(many[:8])


def test_the_only_arena_is_chosen_or_the_one_of_the_name() -> None:
    assert choose([arena("hall")], "").arena == "hall"
    assert choose([arena("hall"), arena("Attic")], "attic").arena == "Attic"
    assert choose([arena("hall"), arena("HALL")], "").arena == "HALL", "one arena: DNS has no capitals"


def test_without_any_announcement_nothing_is_heard() -> None:
    with pytest.raises(UnheardError, match="no arena announces itself in this network: start it, or set"):
        choose([], "")
    with pytest.raises(UnheardError, match="no arena 'hall' announces itself in this network: start it, or set"):
        choose([], "hall")


def test_with_several_arenas_and_no_name_none_is_chosen_and_all_are_named() -> None:
    with pytest.raises(NoArenaError, match="there are several arenas, 'attic', 'hall': choose one with LASERBOT_A"):
        choose([arena("hall"), arena("attic")], "")
    with pytest.raises(NoArenaError, match="'hall 15' and 92 more: choose"):
        choose([arena(f"hall {number}") for number in range(100)][::-1], "")


def test_an_arena_that_is_not_there_is_not_replaced_by_another() -> None:
    with pytest.raises(NoArenaError, match="no arena 'cellar' announces itself in this network; there is 'hall'"):
        choose([arena("hall")], "cellar")
