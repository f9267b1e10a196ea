"""Declared settings: an environment variable's name, default, allowed values and meaning, in one place each."""

import difflib
import os
import re
import sys
from collections.abc import Callable, Mapping, MutableMapping
from dataclasses import dataclass
from ipaddress import ip_address
from typing import Any, Generic, TypeVar

T = TypeVar("T")

# white space, byte order marks and what else editors, spreadsheets and Windows leave around a value
_AROUND = r"[\s\ufeff\u200b-\u200d\u2060\u00ad]+"
# what Kubernetes adds for a Service whose name begins like our variables, and more of that beginning
_OF_A_SERVICE = "_SERVICE_HOST"
_KNOWN: set[str] = set()  # the names of all that are declared

LOG_LEVELS = ("debug", "info", "warning", "error")


class SettingsError(ValueError):
    """A variable has an impossible value; the text names it and what is allowed."""


@dataclass(frozen=True)
class Variable(Generic[T]):
    """One environment variable. `parse` raises ValueError that says what is allowed ("must be ...")."""

    name: str
    default: T
    text: str  # what it is, in Markdown
    parse: Callable[[str], T]
    shown: str  # the default in words, in Markdown
    is_flag: bool = False  # on the command line, its option needs no value
    lowest: float | None = None  # of a number
    highest: float | None = None
    words: tuple[str, ...] = ()  # all that it may be, if these are words
    is_secret: bool = False  # no error shows the value
    pattern: str = ""  # what the whole value looks like, where nothing above says it (RE2)

    def read(self, environ: Mapping[str, str], default: T | None = None) -> T:
        """Its value; unset or empty means the default (`default` before the declared one). SettingsError."""
        text = trimmed(environ.get(self.name, ""))
        if not text:
            return self.default if default is None else default
        try:
            return self.parse(text)
        except ValueError as error:
            raise SettingsError(f"{self.name}{'' if self.is_secret else f'={shown(text)}'}: {error}") from None

    def __post_init__(self) -> None:
        _KNOWN.add(self.name)


def whole(name: str, default: int, lowest: int, highest: int, text: str) -> Variable[int]:
    return Variable(name, default, text, _whole(lowest, highest), str(default), lowest=lowest, highest=highest)


def number(name: str, default: float, lowest: float, highest: float, text: str) -> Variable[float]:
    def parse(given: str) -> float:
        if not (re.fullmatch(r"[0-9]{1,9}(\.[0-9]{1,9})?", given) and lowest <= float(given) <= highest):
            raise ValueError(f"must be a number from {lowest:g} to {highest:g}")
        return float(given)

    return Variable(name, default, text, parse, f"{default:g}", lowest=lowest, highest=highest)


def port(name: str, default: int, text: str) -> Variable[int]:
    return whole(name, default, 1, 65535, text)


def flag(name: str, text: str, *, default: bool = False) -> Variable[bool]:
    """0 or 1."""

    def parse(given: str) -> bool:
        if given not in ("0", "1"):
            raise ValueError("must be 0 or 1")
        return given == "1"

    return Variable(name, default, text, parse, str(int(default)), is_flag=True)


def globs(name: str, text: str) -> Variable[tuple[str, ...] | None]:
    """Patterns of ROS names between commas."""

    def parse(given: str) -> tuple[str, ...]:
        return tuple(pattern.strip(" '\"") for pattern in given.strip("[] ").split(",") if pattern.strip(" '\""))

    return Variable(name, None, text, parse, "all")


def choice(name: str, default: str, allowed: tuple[str, ...], text: str, shown: str = "") -> Variable[str]:
    """One of `allowed`, in any case."""

    def parse(given: str) -> str:
        if given.lower() not in allowed:
            raise ValueError(f"must be one of {', '.join(allowed)}")
        return given.lower()

    text = f"{text}: {', '.join(f'`{word}`' for word in allowed)}"
    return Variable(name, default, text, parse, shown or f"`{default}`", words=allowed)


def words(name: str, default: str, text: str, shown: str = "") -> Variable[str]:
    """Any text."""
    return Variable(name, default, text, str, shown or (f"`{default}`" if default else "none"))


def trimmed(text: str) -> str:
    """Without what nobody sees at its ends."""
    return re.sub(f"^{_AROUND}|{_AROUND}$", "", text)


def shown(text: str) -> str:
    """With escapes for what nobody would see."""
    return text if text.isprintable() else text.encode("unicode_escape").decode()


def tidy(program: str, environ: MutableMapping[str, str]) -> None:
    """Tell what is odd about the variables, once: the programs that this one starts find them tidied up. SettingsError
    for an address that ROS could not use, and would only stumble over later."""

    def tell(text: str) -> None:
        print(f"{program}: {text}", file=sys.stderr, flush=True)

    for name in [name for name in environ if name.startswith(("LASERBOT_", "ROS_"))]:
        text = environ[name]
        if trimmed(text) != text and text.strip(" "):
            tell(f"{name}={shown(text)}: what cannot be seen at its ends is left out")
        environ[name] = trimmed(text)
    for name, mistake in unknown(environ).items():
        tell(mistake)
        del environ[name]
    for address in ROS_ADDRESSES:
        address.read(environ)


def unknown(environ: Mapping[str, str]) -> dict[str, str]:
    """The variables that look like settings and are none, each with a line that names the nearest. The line does not
    show the value: it may be a secret's."""
    services = tuple(name.removesuffix(_OF_A_SERVICE) + "_" for name in environ if name.endswith(_OF_A_SERVICE))
    names = [name for name in environ if name.upper().startswith("LASERBOT") and name not in _KNOWN]
    return {name: _no_such(name) for name in names if not name.startswith(services)}


def _no_such(name: str) -> str:
    nearest = difflib.get_close_matches(name.upper(), _KNOWN, 1)
    return f"{shown(name)}: there is no such setting{f'; the nearest is {nearest[0]}' if nearest else ''}"


def describe(*variables: Variable[Any]) -> str:
    """The variables for a program's `--help`, a line each."""
    width = max(len(variable.name) for variable in variables)
    lines = [f"  {variable.name:{width}}  {variable.text} (default: {variable.shown})" for variable in variables]
    return "environment variables:\n" + re.sub(r"`|\[([^]]*)\]\([^)]*\)", r"\1", "\n".join(lines))


def read_or_exit(program: str, read: Callable[[Mapping[str, str]], T], environ: Mapping[str, str] = os.environ) -> T:
    """`read` the environment; a wrong value ends the program with one line and exit code 2."""
    try:
        tidy(program, os.environ)
        return read(environ)
    except SettingsError as error:
        print(f"{program}: {error}", file=sys.stderr)
        raise SystemExit(2) from None


def _own_ip(given: str) -> str:
    try:
        return str(ip_address(given))
    except ValueError:
        raise ValueError("must be one IP address of this machine") from None


def _own_name(given: str) -> str:
    if not re.fullmatch(r"[\w.:-]+", given):
        raise ValueError("must be a name or an address of this machine, and no more")
    return given


# ROS's own, which it reads itself
ROS_ADDRESSES = (
    Variable("ROS_IP", "", "this machine's address", _own_ip, "found out"),
    Variable("ROS_HOSTNAME", "", "this machine's name", _own_name, "none"),
)


def _whole(lowest: int, highest: int) -> Callable[[str], int]:
    def parse(given: str) -> int:
        if not (re.fullmatch(r"[0-9]{1,9}", given) and lowest <= int(given) <= highest):
            raise ValueError(f"must be a whole number from {lowest} to {highest}")
        return int(given)

    return parse
