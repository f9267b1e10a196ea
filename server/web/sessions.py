"""What a visitor's browser keeps for the game: the session, and in arenas that share it (LASERBOT_DOMAIN) the name."""

from urllib.parse import quote

from flask import Response, current_app, request

from laser_bot_battle.names import SESSION_COOKIE
from server.access.sharing import Sharing, is_token, sharing
from server.web.hosts import request_host
from server.web.visitors import is_secure

DOMAIN = "LASERBOT_DOMAIN"  # in the application's configuration
NAME_COOKIE = "laserbot_name"  # avatar and name, as in 2.Ann%20Lee; for the login page to read
PLAY_COOKIE = "laserbot_play"  # 1: the entrance has just sent the visitor, to play at once
_YEAR = 365 * 24 * 3600  # s
_SENT = 60  # s for which that holds


def brought_token() -> str:
    """The session's token that the visitor has from another arena, or had here before; "" where none is shared."""
    token = request.cookies.get(SESSION_COOKIE, "")
    return token if _sharing().is_shared and is_token(token) else ""


def give_session(response: Response, token: str) -> None:
    domain = _sharing().domain
    if domain:  # one that this host alone gave before would hide it
        response.delete_cookie(SESSION_COOKIE, path="/", httponly=True, samesite="Lax")
    response.set_cookie(
        SESSION_COOKIE, token, domain=domain, path="/", httponly=True, secure=is_secure(), samesite="Lax"
    )


def end_session(response: Response) -> None:
    """Here; another arena may still know it."""
    if not _sharing().is_shared:
        response.delete_cookie(SESSION_COOKIE, path="/", httponly=True, samesite="Lax")


def remember_name(response: Response, name: str, avatar: int) -> None:
    """In all arenas that share their players' sessions."""
    if _sharing().is_shared:
        _keep(response, NAME_COOKIE, f"{avatar}.{quote(name, safe='')}", _YEAR)


def send_to_play(response: Response) -> None:
    """The arena's login page, which comes next, need not ask."""
    _keep(response, PLAY_COOKIE, "1", _SENT)


def _keep(response: Response, name: str, value: str, seconds: int) -> None:
    response.set_cookie(
        name, value, max_age=seconds, domain=_sharing().domain, path="/", secure=is_secure(), samesite="Lax"
    )


def _sharing() -> Sharing:
    return sharing(current_app.config[DOMAIN], request_host())
