"""Who opens a WebSocket: the session cookie in the handshake, if the page that sends it is one of ours."""

import ipaddress
import re
import socket
from collections.abc import Collection
from typing import NamedTuple

from rosgraph.network import get_host_name

from laser_bot_battle.names import SESSION_COOKIE
from server.access.identity import FOREIGN_GUEST, GUEST, Identity, session_identity

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


class OwnPages:
    """The addresses at which browsers find the game's pages."""

    def __init__(self, web_port: int, origins: Collection[str] = (), names: Collection[str] = ()) -> None:
        """`origins` are further ones, as http://host:port; `names` are this machine's."""
        self._web_port = web_port
        self._origins = {origin_of(origin) for origin in origins} - {None}
        self._names = {name.lower() for name in names}

    def identity_of(self, origin: str | None, host: str | None, cookies: list[str]) -> Identity:
        """The identity by the values of the handshake's headers Origin, Host and Cookie.

        A browser sends our cookie whatever page opens the WebSocket. A page that is not the game's must not act for the
        player, so its cookie is ignored. Programs that send no Origin choose their cookies themselves.
        """
        if origin is not None and not self._has(origin, host):
            return FOREIGN_GUEST
        token = session_token(cookies)
        return session_identity(token) if token else GUEST

    def _has(self, origin: str, host: str | None) -> bool:
        """Whether a page of `origin`, which reaches this machine as `host`, is one of the game's."""
        page, here = origin_of(origin), _HOST.fullmatch((host or "").lower())
        if page is None:
            return False
        if page in self._origins:
            return True
        if here is None or page.host != here["host"]:
            return False
        # one address for all, or the web server's own port
        is_here = page.port == int(here["port"] or _PORTS[page.scheme]) or page.port == self._web_port
        return is_here and (is_local(page.host) or page.host in self._names)


def session_token(cookies: list[str]) -> str:
    """What the handshake's Cookie headers hold for us; empty without it. Of two the first, which has the longer path.

    The token has nothing to escape, and a library for those would cost this program 4.5 MB of memory.
    """
    pairs = (pair.strip().partition("=") for header in cookies for pair in header.split(";"))
    return next((value.strip('"') for name, _, value in pairs if name == SESSION_COOKIE), "")


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


def own_names() -> set[str]:
    """This machine's name for itself, and the one by which ROS finds it."""
    return {socket.gethostname(), str(get_host_name())}
