"""laserbot.txt, the file on a card's first partition that says what the card is.

    python3 -m cards.laserbot_txt robot     prints it as it is on a robot's new card; master: on a master's

It is written by hand, on any computer and in any editor. Whatever is wrong in it costs its own line and nothing else.
"""

import difflib
import re
import sys
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from cards import values
from laser_bot_battle import variables
from laser_bot_battle.settings import shown, trimmed

FILE = "laserbot.txt"
LONGEST = 65_536  # bytes; what comes later is not read
_QUOTES = ('""', "''", "“”", "„“", "‘’", "«»")  # pairs
_SECRETS = ("wifi", "wifi_password", "operator_token")  # that can be moved off the partition


@dataclass(frozen=True)
class Card:
    """What the card is, and what the file says. None and (): nothing, so that whoever uses it takes the default."""

    role: str = "robot"  # one of values.ROLES: not the file but the image that was written to the card decides
    arena: str | None = None  # the name of the arena to join, or under which the master announces itself
    name: str | None = None  # of the robot, also as its host
    wifi: str | None = None  # a network's name (SSID)
    wifi_password: str | None = None  # WPA's, or its key as 64 hexadecimal digits
    country: str | None = None  # ISO 3166, two capital letters
    time_zone: str | None = None  # of the zones that were given
    ssh_keys: tuple[str, ...] = ()  # lines of authorized_keys
    operator_token: str | None = None  # at least variables.SHORTEST_TOKEN characters
    camera: str | None = None  # as LASERBOT_CAMERA
    version: str | None = None  # of the game, one of values.VERSIONS
    secrets: str | None = None  # one of values.SECRETS: where they are after the first start


class Mistake(NamedTuple):
    """What is wrong in a line (from 1; 0: in the whole file), for whoever wrote it. No secret is in the text."""

    line: int
    text: str

    def __str__(self) -> str:
        return f"{FILE}{f', line {self.line}' if self.line else ''}: {self.text}"


class _Field(NamedTuple):
    name: str  # in Card
    parse: Callable[[str], str]  # ValueError says what is allowed ("must be ...")
    example: str
    text: str  # for the file's own comments
    is_secret: bool = False  # never told
    written: str = ""  # in the file, if not as in Card
    is_list: bool = False  # each line is one more
    only: str = ""  # for cards with this role

    @property
    def key(self) -> str:
        return self.written or self.name


def parse(content: bytes, zones: Collection[str], role: str) -> tuple[Card, list[Mistake]]:
    """The settings of a file with this content, and its mistakes in the order of their lines.

    `zones` are the time zones that there are ("Europe/Berlin"), `role` is the card's.
    """
    fields = {_letters(field.key): field for field in _fields(zones, role)}
    found: dict[str, Any] = {"role": role}
    lines: dict[str, int] = {}  # where each setting was found
    refused: set[str] = set()
    text, mistakes = _decode(content)
    for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1):
        stripped = trimmed(line)
        if not stripped or stripped.startswith("#"):
            continue
        try:
            field, value = _assignment(stripped, fields)
        except ValueError as error:
            mistakes.append(Mistake(number, str(error)))
            continue
        if not value:
            continue  # as if the line were not there
        try:
            if not value.isprintable():
                raise ValueError("there are characters in it that nobody sees: write it anew")
            value = field.parse(value)
            if field.only not in ("", role):
                raise ValueError(f"is for a {field.only}'s card only")
        except ValueError as error:
            given = "" if field.is_secret else f" = {shown(value)}"
            mistakes.append(Mistake(number, f"{field.key}{given}: {error}"))
            refused.add(field.name)
            continue
        if field.is_list:
            found[field.name] = (*found.get(field.name, ()), value)
        else:
            if field.name in lines:
                mistakes.append(
                    Mistake(number, f"{field.key} stands in line {lines[field.name]}, too: this one counts")
                )
            found[field.name] = value
        lines[field.name] = number
    mistakes += _of_wifi(found, lines, refused)
    return Card(**found), sorted(mistakes, key=lambda mistake: mistake.line)


def _of_wifi(found: dict[str, Any], lines: Mapping[str, int], refused: Collection[str]) -> list[Mistake]:
    """What is wrong with name and password together; a network that cannot be meant is taken out of `found`."""
    if "wifi_password" in refused and "wifi_password" not in found and found.pop("wifi", None):
        # an open network of that name would be somebody else's
        return [Mistake(lines["wifi"], "wifi is not joined, because its password is not valid")]
    if "wifi_password" in found and "wifi" not in found:
        return [Mistake(lines["wifi_password"], "wifi_password: there is no wifi to which it could belong")]
    return []


def without_secrets(content: bytes, zones: Collection[str], role: str) -> bytes:
    """A file without mistakes, with a comment in place of each line that the card alone has to know."""
    fields = {_letters(field.key): field for field in _fields(zones, role)}
    encoding = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}.get(content[:2], "utf-8")

    def moved(match: re.Match[str]) -> str:
        line = trimmed(match[0])
        if not line or line.startswith("#"):
            return match[0]
        field, value = _assignment(line, fields)
        return f"# {field.key}: moved" if field.name in _SECRETS and value else match[0]

    return re.sub(r"[^\r\n]+", moved, content.decode(encoding)).encode(encoding)


def render(role: str) -> str:
    """The file as it is on a new card with this role: each of its settings explained, none set. Its lines end as
    Windows' do, for which old editors there ask."""
    lines = [
        "# What this card is. All of it is optional: a card with this file as it is works, too.",
        "# To set something, remove the # before it and write your own value. It counts from the next start on.",
        f"# What cannot be understood is left out, and told in {FILE.replace('.', '-errors.')} beside this file.",
        "# Whoever holds this card can read what is in this file, passwords too.",
    ]
    for field in _fields(("Europe/Berlin",), role):
        if field.only not in ("", role):
            continue
        lines += ["", *(f"# {line}" for line in field.text.split("\n")), f"#{field.key} = {field.example}"]
    return "\r\n".join([*lines, ""])


def _decode(content: bytes) -> tuple[str, list[Mistake]]:
    mistakes = []
    if len(content) > LONGEST:
        mistakes.append(Mistake(0, f"only the first {LONGEST} bytes are read"))
        content = content[:LONGEST]
    if content and not content.strip(b"\0"):
        return "", [Mistake(0, "there is nothing in it but zeros, as after a pulled plug: write it anew")]
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", "replace"), mistakes
    try:
        return content.decode(), mistakes
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        # older editors of Windows write so
        mistakes.append(Mistake(line, "this is not UTF-8: letters outside of English may be read wrongly"))
        return content.decode("cp1252", "replace"), mistakes


def _assignment(line: str, fields: Mapping[str, _Field]) -> tuple[_Field, str]:
    """Split `name = value`. ValueError for another line, which may be a secret that belongs elsewhere."""
    match = re.match(r"([^=:]*)[=:](.*)", line)
    if not match:
        raise ValueError("this is not `name = value`; a comment begins with #")
    name = _letters(match[1])
    field = fields.get(name)
    if not field:
        # the name is not repeated: in a file like this, it may be a piece of a key
        nearest = difflib.get_close_matches(name, fields, 1)
        known = f"the nearest is {fields[nearest[0]].key}" if nearest else f"there are {_listed(fields)}"
        raise ValueError(f"there is no such setting; {known}")
    return field, _unquoted(trimmed(match[2]))


def _listed(fields: Mapping[str, _Field]) -> str:
    return ", ".join(field.key for field in fields.values())


def _letters(name: str) -> str:
    """What is left of a name whatever its spelling: `Wi-Fi password` is `wifi_password`."""
    return re.sub(r"[\W_]", "", name).lower()


def _unquoted(value: str) -> str:
    return value[1:-1] if len(value) > 1 and value[0] + value[-1] in _QUOTES else value


def _fields(zones: Collection[str], role: str) -> tuple[_Field, ...]:
    """All settings, in the order of the file."""
    return (
        _Field(
            "role",
            lambda text: values.role(text, role),
            role,
            "What this card makes of a Raspberry Pi. It is here to be read: another role is another image.",
        ),
        _Field(
            "arena",
            variables.ARENA_NAME.parse,
            "hall",
            "The arena's name: the master announces itself by it, and robots join it.\n"
            "Needed only if there are several masters in the network.",
        ),
        _Field(
            "name",
            values.host_name,
            "raspberrypi1",
            "The robot's name, also in the network (raspberrypi1.local). Each robot has another one.",
            only="robot",
        ),
        _Field("wifi", values.wifi, "Arena", "The Wi-Fi's name. With a cable, none is needed."),
        _Field("wifi_password", values.wifi_password, "correct horse", "Its password (WPA).", is_secret=True),
        _Field(
            "country", values.country, "DE", "The country's two letters, for the Wi-Fi channels that are allowed there."
        ),
        _Field("time_zone", lambda text: values.zone(text, zones), "Europe/Berlin", "The time zone."),
        _Field(
            "ssh_keys",
            values.ssh_key,
            "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIAABAgMEBQYHCAkKCwwNDg8QERITFBUWFxgZGhscHR4f me@my-computer",
            "Who may log in over SSH as the user pi: the content of a file like id_ed25519.pub.\n"
            "One line for each key.",
            is_secret=True,  # where somebody gives the private one
            written="ssh_key",
            is_list=True,
        ),
        _Field(
            "operator_token",
            variables.OPERATOR_TOKEN.parse,
            "a long secret of yours",
            f"Opens the operator's desk. At least {variables.SHORTEST_TOKEN} characters.",
            is_secret=True,
            only="master",
        ),
        _Field(
            "camera",
            values.camera,
            "/dev/video0",
            "The robot's USB camera.",
            only="robot",
        ),
        _Field(
            "version",
            values.version,
            values.PREVIOUS,
            "The version of the game: newest, or previous for the one before the last update. The robots follow.",
            only="master",
        ),
        _Field(
            "secrets",
            values.secrets,
            values.MOVE,
            "What becomes of the lines wifi, wifi_password and operator_token at the next start: keep leaves them\n"
            "here, move takes them to the card's own partition, which Windows and macOS do not show. To change the\n"
            "Wi-Fi then, write wifi and wifi_password again.",
        ),
    )


if __name__ == "__main__":
    sys.stdout.reconfigure(newline="")  # type: ignore[union-attr]
    sys.stdout.write(render(sys.argv[1]))
