"""Who opens a WebSocket: the session cookie in the handshake, if the page that sends it is one of ours."""

from urllib.parse import urlsplit

from werkzeug.sansio.http import parse_cookie

from laser_bot_battle.names import SESSION_COOKIE
from server.rosbridge.gate import GUEST, Identity, session_identity


def identity_of(origin: str | None, host: str | None, cookies: list[str]) -> Identity:
    """The identity by the values of the handshake's headers Origin, Host and Cookie.

    A browser sends our cookie whatever page opens the WebSocket. A page of another host must not act for the player,
    so its cookie is ignored: it may watch. Programs that send no Origin choose their cookies themselves.
    """
    if origin is not None and host_name(origin) != host_name(f"//{host}"):
        return GUEST
    token = parse_cookie(";".join(cookies)).get(SESSION_COOKIE)  # of two the first, which has the longer path
    return session_identity(token) if token else GUEST


def host_name(url: str) -> str | None:
    """The host without port, in lower case; None when there is none."""
    try:
        return urlsplit(url).hostname
    except ValueError:
        return None
