"""Which pages are the game's own: decided here for forms, WebSockets and cookies alike."""

import ipaddress
import re
from collections.abc import Collection
from enum import Enum, auto
from typing import NamedTuple

# As browsers write them: RFC 6454 6.2 (Origin) and RFC 9110 7.2 (Host); names in any script come as xn--...
_AUTHORITY = r"(?P<host>[a-z0-9._-]+|\[[0-9a-f:.]+\])(?::(?P<port>[0-9]{1,5}))?"
_ORIGIN = re.compile(rf"(?P<scheme>https?)://{_AUTHORITY}")
_HOST = re.compile(_AUTHORITY)
_PORTS = {"http": 80, "https": 443}


class Origin(NamedTuple):
    """Where a page comes from."""

    scheme: str
    host: str  # in lower case, an IPv6 address in brackets
    port: int


class Standing(Enum):
    """What a page is to the game."""

    OWN = auto()  # it acts for whoever looks at it
    UNSURE = auto()  # at this very address, by a name that its owner may have pointed here (DNS rebinding)
    FOREIGN = auto()


class PageAddresses:
    """The addresses at which browsers find the game's pages."""

    def __init__(self, web_port: int | None, origins: Collection[str] = (), names: Collection[str] = ()) -> None:
        """`web_port` is the pages' where the question is asked at another one; `origins` are further ones, as
        http://host:port; `names` are this machine's."""
        self._web_port = web_port
        self._origins = {origin_of(origin) for origin in origins} - {None}
        self._names = {name.lower() for name in names}

    def standing(self, origin: str, authority: str | None) -> Standing:
        """Of a page of `origin`, as the header of that name says it. The page reaches this machine as `authority`: what
        the header Host says, or a believed proxy in its place (laser_bot_battle.proxies.Asked)."""
        page, here = origin_of(origin), _HOST.fullmatch((authority or "").lower())
        if page is None:
            return Standing.FOREIGN
        if page in self._origins:
            return Standing.OWN
        if here is None or page.host != here["host"]:
            return Standing.FOREIGN
        # one address for all, or the web server's own port
        if page.port not in (int(here["port"] or _PORTS[page.scheme]), self._web_port):
            return Standing.FOREIGN
        return Standing.OWN if is_local(page.host) or page.host in self._names else Standing.UNSURE


def origin_of(text: str) -> Origin | None:
    """An Origin with its port spelled out; None for what no page of ours can have, such as null or file://."""
    match = _ORIGIN.fullmatch(text.lower())
    return match and Origin(match["scheme"], match["host"], int(match["port"] or _PORTS[match["scheme"]]))


def is_local(host: str) -> bool:
    """Whether `host` cannot be a name of the internet's DNS: its owner could let it point to this machine (DNS
    rebinding), and the pages there would then be ours."""
    if "." not in host or host.endswith(".local"):
        return True
    try:
        ipaddress.ip_address(host.strip("[]"))
    except ValueError:
        return False
    return True
