"""What a card's settings become on its system."""

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from cards.files import files
from cards.laserbot_txt import Card, render
from cards.start import start
from cards.telling import ERRORS, tell
from tests.support.updates import Cut

WIFI = "/etc/wpa_supplicant/wpa_supplicant-wlan0.conf"
KEYS = "/home/pi/.ssh/authorized_keys"
KEY = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIAABAgMEBQYHCAkKCwwNDg8QERITFBUWFxgZGhscHR4f"


@pytest.fixture
def boot(tmp_path: Path) -> Path:
    (tmp_path / "boot").mkdir()
    return tmp_path / "boot"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    (tmp_path / "root/proc/device-tree").mkdir(parents=True)
    (tmp_path / "root/proc/device-tree/serial-number").write_bytes(b"00000000abcdef12\0")
    return tmp_path / "root"


@pytest.mark.parametrize(
    "line, expected",
    [("", "raspberrypi-cdef12"), ("name = raspberrypi7", "raspberrypi7")],
)
def test_a_host_has_a_name_of_its_own(line: str, expected: str, boot: Path, root: Path) -> None:
    (boot / "laserbot.txt").write_text(line)
    start(boot, root, "robot")
    assert (root / "etc/hostname").read_text() == f"{expected}\n"


@pytest.mark.parametrize(
    "card, lines",
    [
        (Card(wifi='a"b\\', wifi_password='pass"word'), ["ssid=6122625c", 'psk="pass"word"', "key_mgmt=WPA-PSK SAE"]),
        (Card(wifi="hall", wifi_password="0a" * 32), [f"psk={'0a' * 32}"]),
        (Card(wifi="hall"), ["key_mgmt=NONE"]),
        (Card(wifi="hall", country="DE"), ["country=DE"]),
    ],
)
def test_the_wifi_is_joined_whatever_its_name_is(card: Card, lines: list[str]) -> None:
    content = files(card)[WIFI].content
    assert not set(lines) - {line.strip() for line in content.splitlines()}


def test_a_new_card_starts_without_a_word(boot: Path, root: Path) -> None:
    (boot / "laserbot.txt").write_text(render("robot"))
    start(boot, root, "robot")
    assert (root / "etc/hostname").read_text() == "raspberrypi-cdef12\n"
    assert [path.name for path in (root / "etc").iterdir()] == ["hostname"]
    assert not (boot / ERRORS).exists()


def test_what_is_said_holds(boot: Path, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    owned = []
    monkeypatch.setattr("cards.start.shutil.chown", lambda path, user, group: owned.append((path.name, user, group)))
    (boot / "laserbot.txt").write_text(f"time_zone = Europe/Paris\nssh_key = {KEY}\nwifi = hall\nname = r1\n")
    start(boot, root, "robot")
    assert (root / "etc/localtime").readlink() == Path("/usr/share/zoneinfo/Europe/Paris")
    assert (root / KEYS[1:]).read_text() == f"{KEY}\n"
    assert owned == [("authorized_keys.new", "pi", "pi")]
    for secret in (KEYS, WIFI):
        assert (root / secret[1:]).stat().st_mode & 0o777 == 0o600


def test_what_is_not_said_is_left_to_others(boot: Path, root: Path) -> None:
    """To Ansible, which has deployed to the host."""
    (root / "etc").mkdir()
    (root / "etc/hostname").write_text("raspberrypi5\n")
    (root / "etc/localtime").symlink_to("/usr/share/zoneinfo/Asia/Tokyo")
    (boot / "laserbot.txt").write_text(render("robot"))
    start(boot, root, "robot")
    assert (root / "etc/hostname").read_text() == "raspberrypi5\n"
    assert (root / "etc/localtime").readlink() == Path("/usr/share/zoneinfo/Asia/Tokyo")


def test_nothing_is_written_that_is_as_it_should_be(boot: Path, root: Path) -> None:
    (boot / "laserbot.txt").write_text("name = r1\nrole = both\n")
    start(boot, root, "robot")
    before = {path: path.lstat().st_ino for folder in (boot, root) for path in folder.rglob("*")}
    start(boot, root, "robot")
    assert {path: path.lstat().st_ino for folder in (boot, root) for path in folder.rglob("*")} == before


def test_mistakes_are_told_beside_the_file_until_they_are_gone(
    boot: Path, root: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (boot / "laserbot.txt").write_text("name = r1\nrole = both\n")
    start(boot, root, "robot")
    told = "laserbot.txt, line 2: role = both: must be robot or master"
    assert (boot / ERRORS).read_bytes() == f"{told}\r\n".encode()
    assert capsys.readouterr().err == f"{told}\n"
    assert (root / "etc/hostname").read_text() == "r1\n"
    (boot / "laserbot.txt").write_text("name = r1\n")
    start(boot, root, "robot")
    assert not (boot / ERRORS).exists()


def test_what_is_wrong_later_is_told_below(boot: Path, root: Path) -> None:
    (boot / "laserbot.txt").write_text("role = both\n")
    start(boot, root, "robot")
    tell(boot, "laserbot-2.update", "is broken")
    lines = ["laserbot.txt, line 1: role = both: must be robot or master", "laserbot-2.update: is broken", ""]
    assert (boot / ERRORS).read_bytes() == "\r\n".join(lines).encode()
    tell(boot / "no partition", "the game", "is told on the screen all the same")


def test_a_problem_is_told_once_until_it_changes_or_ends(boot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for problem in ("no engine", "no engine", "no\n room", "no engine"):
        tell(boot, "the update", "is broken")
        tell(boot, "the game", problem)
    assert (boot / ERRORS).read_text().splitlines() == ["the update: is broken", "the game: no engine"]
    screen = ["the update: is broken", "the game: no engine", "the game: no room", "the game: no engine"]
    assert capsys.readouterr().err.splitlines() == screen
    tell(boot, "the game", "")
    assert (boot / ERRORS).read_bytes() == b"the update: is broken\r\n"
    tell(boot, "the update", "")
    assert not (boot / ERRORS).exists()


def test_a_robots_card_is_no_master_and_says_so(boot: Path, root: Path) -> None:
    (boot / "laserbot.txt").write_text(f"role = master\noperator_token = {'0' * 16}\n")
    start(boot, root, "robot")
    told = (boot / ERRORS).read_text().splitlines()
    assert [line.partition(":")[0] for line in told] == ["laserbot.txt, line 1", "laserbot.txt, line 2"]
    assert [path.name for path in (root / "etc").iterdir()] == ["hostname"]
    assert (root / "etc/hostname").read_text() == "raspberrypi-cdef12\n"


def test_a_masters_card_has_the_masters_name_and_the_operators_token(
    boot: Path, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    owned = []
    monkeypatch.setattr("cards.start.shutil.chown", lambda path, user, group: owned.append((user, group)))
    (boot / "laserbot.txt").write_text("operator_token = correct horse battery\n")
    start(boot, root, "master")
    token = root / "etc/laserbot/operator-token"
    assert (root / "etc/hostname").read_text() == "laser-bot-master\n"
    assert token.read_text() == "correct horse battery"
    assert token.stat().st_mode & 0o777 == 0o400
    assert owned == [(10001, 10001)], "the containers' user"
    assert not (boot / ERRORS).exists()


def test_a_token_that_is_too_short_is_refused_and_the_one_before_stays(boot: Path, root: Path) -> None:
    token = root / "etc/laserbot/operator-token"
    token.parent.mkdir(parents=True)
    token.write_text("the one that Ansible has deployed")
    (boot / "laserbot.txt").write_text(f"operator_token = {'x' * 15}\n")
    start(boot, root, "master")
    assert "line 1: operator_token: the token needs at least 16 characters" in (boot / ERRORS).read_text()
    assert token.read_text() == "the one that Ansible has deployed"
    assert (root / "etc/hostname").read_text() == "laser-bot-master\n"


def test_secrets_are_moved_if_the_file_says_so_and_stay_in_force(
    boot: Path, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cards.start.shutil.chown", lambda *_: None)
    text = "wifi = hall\nwifi_password = correct horse\noperator_token = correct horse battery\nsecrets = move\n"
    (boot / "laserbot.txt").write_text(text)
    for _ in range(2):
        start(boot, root, "master")
        left = (boot / "laserbot.txt").read_text()
        assert "correct" not in left
        assert [line.rstrip() for line in left.splitlines()] == [
            "# wifi: moved",
            "# wifi_password: moved",
            "# operator_token: moved",
            "secrets = move",
        ]
        assert 'psk="correct horse"' in (root / WIFI[1:]).read_text()
        assert (root / "etc/laserbot/operator-token").read_text() == "correct horse battery"
    assert not (boot / ERRORS).exists()


@pytest.mark.parametrize("line", ["secrets = keep", "secrets = move\nrole = both"])
def test_secrets_stay_if_the_file_says_so_or_something_in_it_is_wrong(line: str, boot: Path, root: Path) -> None:
    text = f"wifi = hall\nwifi_password = correct horse\n{line}\n"
    (boot / "laserbot.txt").write_text(text)
    start(boot, root, "robot")
    assert (boot / "laserbot.txt").read_text() == text


def test_moved_secrets_are_not_left_in_a_file_without_a_name(boot: Path, root: Path) -> None:
    file = boot / "laserbot.txt"
    file.write_text("wifi = hall\nwifi_password = correct horse\nsecrets = move\n")
    with file.open("rb") as old:
        start(boot, root, "robot")
        assert set(old.read()) == {0}


@pytest.mark.parametrize("step", ["fsync", "replace", "sync"])
def test_a_cut_while_secrets_are_moved_leaves_the_old_file_or_the_new(
    step: str, boot: Path, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin = "wifi = hall\nwifi_password = correct horse\nsecrets = move\n"
    (boot / "laserbot.txt").write_text(begin)
    start(boot, root, "robot")
    end = (boot / "laserbot.txt").read_text()
    for times in range(3):
        (boot / "laserbot.txt").write_text(begin)
        left, real = times, getattr(os, step)

        def cut(*arguments: object, real: Callable[..., object] = real) -> None:
            nonlocal left
            if not left:
                raise Cut
            left -= 1
            real(*arguments)

        with monkeypatch.context() as patch, suppress(Cut):
            patch.setattr(os, step, cut)
            start(boot, root, "robot")
        assert (boot / "laserbot.txt").read_text() in (begin, end)
        start(boot, root, "robot")
        assert (boot / "laserbot.txt").read_text() == end
        assert 'psk="correct horse"' in (root / WIFI[1:]).read_text()
        assert not (boot / ERRORS).exists()


def test_letters_that_are_none_do_not_stop_the_start(boot: Path, root: Path) -> None:
    (boot / "laserbot.txt").write_bytes("name = r1\nsecrets = move\n#".encode("utf-16") + b"\xd8")
    start(boot, root, "robot")
    assert (root / "etc/hostname").read_text() == "r1\n"


def test_a_card_without_the_file_or_even_its_partition_starts(boot: Path, root: Path) -> None:
    start(boot, root, "robot")
    assert "cannot be read" in (boot / ERRORS).read_text()
    (boot / ERRORS).unlink()
    boot.rmdir()
    start(boot, root, "robot")
    assert (root / "etc/hostname").read_text() == "raspberrypi-cdef12\n"
