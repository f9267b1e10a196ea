"""Who opens a WebSocket: the session cookie in the handshake, if the page that sends it is one of ours."""

from collections.abc import Mapping
from urllib.parse import urlsplit

from server.rosbridge.gate import ANYBODY, Identity, session_identity

COOKIE = "laserbot_session"


def identity_of(origin: str | None, host: str | None, cookies: list[str]) -> Identity:
    """The identity by the values of the handshake's headers Origin, Host and Cookie.

    A browser sends our cookie whatever page opens the WebSocket. A page of another host must not act for the player,
    so its cookie is ignored: it may watch. Programs that send no Origin choose their cookies themselves.
    """
    if origin is not None and host_name(origin) != host_name(f"//{host}"):
        return ANYBODY
    token = parse_cookies(cookies).get(COOKIE)
    return session_identity(token) if token else ANYBODY


def host_name(url: str) -> str | None:
    """The host without port, in lower case; None when there is none."""
    try:
        return urlsplit(url).hostname
    except ValueError:
        return None


def parse_cookies(headers: list[str]) -> Mapping[str, str]:
    """Name and value of each cookie (RFC 6265 4.2.1); of two of one name the first, which is the more specific."""
    pairs = [pair.partition("=") for header in headers for pair in header.split(";")]
    return {name.strip(): value.strip().strip('"') for name, _, value in reversed(pairs)}
