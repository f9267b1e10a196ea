"""What a master tells its network about itself, by DNS-SD (RFC 6763, docs/discovery.md), and which one to choose."""

import ipaddress
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from laser_bot_battle.names import VERSION

SERVICE = "_laserbot._tcp.local."
MAX_ADDRESSES = 8
MAX_NAME = 63  # bytes of UTF-8 in a label of DNS
MAX_OWN_NAME = 60  # with room for the "-2" of a second one of the same name
MAX_NAMED = 8  # arenas in one line of text


class NoArenaError(Exception):
    """There is no arena to join; the text says why and what to do."""


class UnheardError(NoArenaError):
    """Nothing is announced here at all: there is no arena, or multicast does not pass."""


@dataclass(frozen=True)
class Announcement:
    """One arena. `addresses` are IPv4, the ports are the master's."""

    arena: str
    addresses: tuple[str, ...]
    web: int
    rosbridge: int
    ros: int
    version: str

    def text(self) -> dict[str, str]:
        """The keys and values of the TXT record."""
        return {"version": self.version, "rosbridge": str(self.rosbridge), "ros": str(self.ros)}


def shortened(name: str) -> str:
    """As much of the name as can be announced."""
    return name.encode(errors="ignore")[:MAX_OWN_NAME].decode(errors="ignore")


def arena_of(instance: str) -> str:
    """The arena's name within the full name of its service."""
    return instance.removesuffix(f".{SERVICE}")


def read(instance: str, port: int | None, text: Mapping[bytes, bytes | None], addresses: Iterable[str]) -> Announcement:
    """What a service's records say. ValueError with what is wrong with them, for people."""
    arena = arena_of(instance)
    if not (arena.isprintable() and 0 < len(arena.encode()) <= MAX_NAME):
        raise ValueError("its name is not one of an arena")
    version = _word(text, "version")
    if version.split(".")[0] != VERSION.split(".")[0]:
        raise ValueError(f"it is of version {version}, and this program of {VERSION}: bring them to the same")
    usable = tuple(address for address in addresses if _is_usable(address))[:MAX_ADDRESSES]
    if not usable:
        raise ValueError("it names no address")
    return Announcement(
        arena=arena,
        addresses=usable,
        web=_port("its web port", str(port)),
        rosbridge=_port("its rosbridge port", _word(text, "rosbridge")),
        ros=_port("its ROS port", _word(text, "ros")),
        version=version,
    )


def choose(announced: Iterable[Announcement], wanted: str) -> Announcement:
    """The arena of the name `wanted` ("": of any, if there is one only). NoArenaError when that leaves none."""
    arenas = {announcement.arena.casefold(): announcement for announcement in announced}
    names = ", ".join(repr(arenas[name].arena) for name in sorted(arenas)[:MAX_NAMED])
    if len(arenas) > MAX_NAMED:
        names += f" and {len(arenas) - MAX_NAMED} more"
    if not arenas:
        what = f"no arena {wanted!r}" if wanted else "no arena"
        raise UnheardError(f"{what} announces itself in this network: start it, or set LASERBOT_MASTER to its address")
    if wanted:
        if wanted.casefold() not in arenas:
            raise NoArenaError(f"no arena {wanted!r} announces itself in this network; there is {names}")
        return arenas[wanted.casefold()]
    if len(arenas) > 1:
        raise NoArenaError(f"there are several arenas, {names}: choose one with LASERBOT_ARENA")
    return next(iter(arenas.values()))


def _word(text: Mapping[bytes, bytes | None], key: str) -> str:
    value = (text.get(key.encode()) or b"").decode(errors="replace")
    if not (value.isprintable() and 0 < len(value) <= 32):
        raise ValueError(f"its {key} is missing")
    return value


def _port(what: str, text: str) -> int:
    if not (text.isascii() and text.isdecimal() and len(text) <= 5 and 0 < int(text) < 1 << 16):
        raise ValueError(f"{what} is not a port")
    return int(text)


def _is_usable(address: str) -> bool:
    """Whether that is a host's IPv4 address: ROS knows no others."""
    try:
        known = ipaddress.IPv4Address(address)
    except ValueError:
        return False
    return not (known.is_loopback or known.is_multicast or known.is_unspecified or known.is_reserved)
