"""What people write into laserbot.txt, and what a card makes of it."""

import os
import re
import subprocess
from dataclasses import fields

import pytest

from cards.laserbot_txt import LONGEST, Card, Mistake, parse, render, without_secrets
from tests.support.programs import ROOT

ZONES = ("America/New_York", "Etc/UTC", "Europe/Berlin", "Europe/London")
KEY = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIAABAgMEBQYHCAkKCwwNDg8QERITFBUWFxgZGhscHR4f"
TOKEN = "0123456789abcdef"


@pytest.mark.parametrize(
    "line, expected",
    [
        ("role = master", Card(role="master")),
        ("ROLE=Robot", Card()),
        ("arena = Große Halle", Card(arena="Große Halle")),
        ("name = RaspberryPi7", Card(name="raspberrypi7")),
        ("Name: raspberrypi7", Card(name="raspberrypi7")),
        ("wifi = Café 2.4 = fast: very", Card(wifi="Café 2.4 = fast: very")),
        ("Wi-Fi = Arena", Card(wifi="Arena")),
        ("wifi = Arena # 5", Card(wifi="Arena # 5")),
        ('wifi = " Arena "', Card(wifi=" Arena ")),
        ("wifi = “Arena”", Card(wifi="Arena")),
        ('wifi = ""Arena""', Card(wifi='"Arena"')),
        ('wifi = 5" screen', Card(wifi='5" screen')),
        ("wifi=A\nWi-Fi password = a=b:c #d e", Card(wifi="A", wifi_password="a=b:c #d e")),
        (f"wifi_password = {'0aF1' * 16}\nwifi=A", Card(wifi="A", wifi_password="0aF1" * 16)),
        ("secrets = Move", Card(secrets="move")),
        ("country = de", Card(country="DE")),
        ("time zone = europe/berlin", Card(time_zone="Europe/Berlin")),
        ("TimeZone: America/New York", Card(time_zone="America/New_York")),
        (f"ssh_key = {KEY} me@my computer", Card(ssh_keys=(f"{KEY} me@my computer",))),
        (f"operator_token = {TOKEN}", Card(role="master", operator_token=TOKEN)),
        ("camera = /dev/video0", Card(camera="/dev/video0")),
        ("version = Previous", Card(role="master", version="previous")),
        ("version = newest", Card(role="master", version="newest")),
        ("\ufeff\u200b  role\u00a0=\u00a0robot\u200b\u00a0\t", Card()),
        ("   # role = master", Card()),
        ("role =", Card()),
        ('arena = ""', Card()),
        ("", Card()),
    ],
)
def test_a_line_is_understood(line: str, expected: Card) -> None:
    assert parse(line.encode(), ZONES, expected.role) == (expected, [])


@pytest.mark.parametrize(
    "line, told",
    [
        ("role = Roboter", "role = Roboter: must be robot or master"),
        ("role = Master", "role = Master: this is a robot's card; a master's is made from laserbot-master.img.xz"),
        (f"operator_token = {TOKEN}", "operator_token: is for a master's card only"),
        ("arenas = hall", "there is no such setting; the nearest is arena"),
        ("wifi_pasword = secret word", "there is no such setting; the nearest is wifi_password"),
        ("ssh_keys = x", "there is no such setting; the nearest is ssh_key"),
        (
            "xyz = secret",
            "there is no such setting; there are role, arena, name, wifi, wifi_password, country, time_zone, ssh_key, "
            "operator_token, camera, version, secrets",
        ),
        ("= robot", "there is no such setting; there are role, "),
        (KEY, "this is not `name = value`; a comment begins with #"),
        ("-----BEGIN OPENSSH PRIVATE KEY-----", "this is not `name = value`; a comment begins with #"),
        ("arena = a.b", "arena = a.b: must be a name of at most 60 bytes without dots, and not begin with _"),
        ("arena = ha\u200bll", r"arena = ha\u200bll: there are characters in it that nobody sees: write it anew"),
        ("name = robot_1", "name = robot_1: must be at most 63 letters (a to z), digits and -, which"),
        ("name = -robot", "name = -robot: must be "),
        (f"name = {'x' * 64}", "must be at most 63 letters"),
        (f"wifi = {'é' * 17}", "must be at most 32 bytes"),
        (
            "wifi_password = short",
            "wifi_password: must be 8 to 63 letters (a to z), digits and signs, or 64 hexadecimal",
        ),
        ("wifi_password = pässword", "wifi_password: must be 8 to 63 "),
        ("wifi_password = pass\u00a0word", "wifi_password: there are characters in it that nobody sees: write it anew"),
        ("country = Germany", "country = Germany: must be the two letters of ISO 3166, such as DE, GB or US"),
        ("country = uk", "country = uk: must be the two letters of ISO 3166"),
        (
            "time_zone = Europe/Berln",
            "time_zone = Europe/Berln: there is no such time zone; the nearest is Europe/Berlin",
        ),
        ("time_zone = london", "time_zone = london: there is no such time zone; the nearest is Europe/London"),
        ("time_zone = 17", "time_zone = 17: there is no such time zone"),
        (
            "ssh_key = ~/.ssh/id_ed25519.pub",
            "ssh_key: must be a whole public key in one line, such as ssh-ed25519 AAAA",
        ),
        (f"ssh_key = {KEY[:20]}", "ssh_key: must be a whole public key"),
        (f"ssh_key = {KEY.replace('ed25519', 'rsa')}", "ssh_key: must be a whole public key"),
        ("operator_token = too short", "operator_token: the token needs at least 16 characters"),
        ("version = previous", "version = previous: is for a master's card only"),
        ("camera = video0", "camera = video0: must be a device such as /dev/video0"),
        ("camera = LibCamera", "camera = LibCamera: the card's kernel has no driver for the Raspberry Pi's own camera"),
    ],
)
def test_a_wrong_line_is_told_and_costs_nothing_else(line: str, told: str) -> None:
    card, [mistake] = parse(f"# hall\r\n{line}\r\ncountry = FR\r\n".encode(), ZONES, "robot")
    assert card == Card(country="FR")
    assert mistake.line == 2
    assert told in mistake.text
    assert str(mistake) == f"laserbot.txt, line 2: {mistake.text}"


def test_a_wifi_whose_password_cannot_be_one_is_not_joined_as_an_open_one() -> None:
    card, mistakes = parse(b"country = FR\nwifi = hall\nwifi_password = short\n", ZONES, "robot")
    assert card == Card(country="FR")
    assert [str(mistake).partition(" must")[0] for mistake in mistakes] == [
        "laserbot.txt, line 2: wifi is not joined, because its password is not valid",
        "laserbot.txt, line 3: wifi_password:",
    ]


@pytest.mark.parametrize("secrets", ["keep", "move"])
def test_a_password_without_a_wifi_is_told(secrets: str) -> None:
    card, [mistake] = parse(f"wifi_password = correct horse\nsecrets = {secrets}\n".encode(), ZONES, "robot")
    assert card == Card(wifi_password="correct horse", secrets=secrets)
    assert str(mistake) == "laserbot.txt, line 1: wifi_password: there is no wifi to which it could belong"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_file_without_its_secrets_says_the_rest(encoding: str) -> None:
    lines = ["# mine", "Wi-Fi = Café", "", "  wifi_password: correct horse", f"operator_token = {TOKEN}"]
    lines += ["arena = Große Halle", "secrets = move", "#wifi_password = an example", "wifi ="]
    rest = without_secrets("\r\n".join(lines).encode(encoding), ZONES, "master")
    assert parse(rest, ZONES, "master") == (Card(role="master", arena="Große Halle", secrets="move"), [])
    assert rest.decode(encoding).lstrip("\ufeff").split("\r\n") == [
        "# mine",
        "# wifi: moved",
        "",
        "# wifi_password: moved",
        "# operator_token: moved",
        *lines[5:],
    ]
    assert without_secrets(rest, ZONES, "master") == rest


@pytest.mark.parametrize(
    "line, told",
    [
        ("role = robot", "role = robot: this is a master's card; a robot's is made from laserbot-robot.img.xz"),
        ("name = raspberrypi7", "name = raspberrypi7: is for a robot's card only"),
        ("camera = /dev/video0", "camera = /dev/video0: is for a robot's card only"),
        ("version = 1.0.0", "version = 1.0.0: must be newest or previous"),
        (f"operator_token = {TOKEN[:-1]}", "operator_token: the token needs at least 16 characters"),
    ],
)
def test_a_masters_card_is_no_robots(line: str, told: str) -> None:
    card, [mistake] = parse(f"{line}\narena = hall\n".encode(), ZONES, "master")
    assert card == Card(role="master", arena="hall")
    assert str(mistake).startswith(f"laserbot.txt, line 1: {told}")


def test_no_secret_is_in_what_is_told() -> None:
    secret = "hunter2"
    lines = [f"wifi_password = {secret}", f"operator_token = {secret}", f"wifipasswort {secret}", f"{secret} = x"]
    lines += [f"ssh_key = {secret}", f"wifi_passwd: {secret}"]
    _, mistakes = parse("\n".join(lines).encode(), ZONES, "master")
    assert [mistake.line for mistake in mistakes] == [1, 2, 3, 4, 5, 6]
    assert not [mistake for mistake in mistakes if secret in str(mistake)]


def test_each_key_is_one_more_and_of_other_settings_the_last_counts() -> None:
    card, mistakes = parse(
        f"ssh_key={KEY} a\nssh_key={KEY} b\narena=hall\narena=yard\narena=\n".encode(), ZONES, "robot"
    )
    assert card == Card(ssh_keys=(f"{KEY} a", f"{KEY} b"), arena="yard")
    assert mistakes == [Mistake(4, "arena stands in line 3, too: this one counts")]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_any_editor_will_do(encoding: str, end: str) -> None:
    content = end.join(["arena = Große Halle", "", "wifi = Arena"]).encode(encoding)
    assert parse(content, ZONES, "robot") == (Card(arena="Große Halle", wifi="Arena"), [])


def test_an_old_editors_letters_are_read_and_told() -> None:
    card, mistakes = parse("role = robot\r\narena = Große Halle".encode("cp1252"), ZONES, "robot")
    assert card == Card(arena="Große Halle")
    assert [mistake.line for mistake in mistakes] == [2]


@pytest.mark.parametrize(
    "content", [b"\0" * 512, b"\xff\xfe\x00", b"\xfe\xff", bytes(range(256)) * 16, b"=" * 999, b"\x81\r\n"]
)
def test_nothing_in_the_file_stops_the_start(content: bytes) -> None:
    parse(content, ZONES, "robot")
    card, _ = parse(b"country = FR\n" + content, ZONES, "robot")
    assert card.country == "FR"


def test_a_file_that_a_pulled_plug_has_emptied_is_told() -> None:
    card, [mistake] = parse(b"\0" * 512, ZONES, "robot")
    assert card == Card()
    assert str(mistake).startswith("laserbot.txt: there is nothing in it but zeros")
    assert parse(b"", ZONES, "robot") == (Card(), [])


def test_the_rest_of_an_endless_file_is_told() -> None:
    content = b"arena = hall\n" + b"#" * LONGEST + b"\narena = yard"
    assert parse(content, ZONES, "robot") == (
        Card(arena="hall"),
        [Mistake(0, f"only the first {LONGEST} bytes are read")],
    )


@pytest.mark.parametrize("role, others", [("robot", {"operator_token", "version"}), ("master", {"name", "camera"})])
def test_a_new_card_sets_nothing_and_explains_everything(role: str, others: set[str]) -> None:
    assert parse(render(role).encode(), ZONES, role) == (Card(role=role), [])
    # each setting is there as an example that holds once its # is removed
    card, mistakes = parse(re.sub(r"^#(?=\w+ = )", "", render(role), flags=re.MULTILINE).encode(), ZONES, role)
    assert not mistakes
    assert {field.name for field in fields(Card) if not getattr(card, field.name)} == others
    assert max(map(len, render(role).splitlines())) <= 120


@pytest.mark.parametrize("role", ["robot", "master"])
def test_the_program_prints_the_file_with_the_line_ends_of_windows(role: str) -> None:
    environ = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT}/laser_bot_battle/src"}
    command = ["/usr/bin/python3", "-m", "cards.laserbot_txt", role]
    printed = subprocess.run(command, cwd=ROOT, env=environ, stdout=subprocess.PIPE, check=True).stdout
    assert printed == render(role).encode()
    assert printed.count(b"\r\n") == printed.count(b"\n") > 20
