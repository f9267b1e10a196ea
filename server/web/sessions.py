"""What a visitor's browser keeps for the game: the session, and in arenas that share it (LASERBOT_DOMAIN) the name."""

from urllib.parse import quote

from flask import Response, current_app, request
from werkzeug.wrappers import Request

from laser_bot_battle.names import SECURE_SESSION_COOKIE, SESSION_COOKIE, SESSION_COOKIES
from server.access.sharing import Sharing, is_token, sharing
from server.web.hosts import request_host
from server.web.visitors import is_secure

DOMAIN = "LASERBOT_DOMAIN"  # in the application's configuration
NAME_COOKIE = "laserbot_name"  # avatar and name, as in 2.Ann%20Lee; for the login page to read
PLAY_COOKIE = "laserbot_play"  # 1: the entrance has just sent the visitor, to play at once
_YEAR = 365 * 24 * 3600  # s
_SENT = 60  # s for which that holds


def token_of(asked: Request) -> str:
    """The session's token that the request brings, "" without one."""
    return next((token for name in SESSION_COOKIES if (token := asked.cookies.get(name))), "")


def brought_token() -> str:
    """The session's token that the visitor has from another arena, or had here before; "" where none is shared."""
    token = token_of(request)
    return token if _sharing().is_shared and is_token(token) else ""


def give_session(response: Response, token: str) -> None:
    domain = _sharing().domain
    if domain:  # one that this host alone gave before would hide it
        _take_session(response)
    name = SECURE_SESSION_COOKIE if is_secure() else SESSION_COOKIE
    response.set_cookie(name, token, domain=domain, path="/", httponly=True, secure=is_secure(), samesite="Lax")


def end_session(response: Response) -> None:
    """By the visitor's own wish: the name is not remembered any more, in no arena. The session ends here; another arena
    that shares it may still know it."""
    shared = _sharing()
    if shared.is_shared:
        response.delete_cookie(NAME_COOKIE, domain=shared.domain, path="/", samesite="Lax")
    else:
        _take_session(response)


def _take_session(response: Response) -> None:
    """Of this host alone."""
    name = SECURE_SESSION_COOKIE if is_secure() else SESSION_COOKIE
    response.delete_cookie(name, path="/", httponly=True, secure=is_secure(), samesite="Lax")


def remember_name(response: Response, name: str, avatar: int) -> None:
    """In all arenas that share their players' sessions."""
    if _sharing().is_shared:
        _keep(response, NAME_COOKIE, f"{avatar}.{quote(name, safe='')}", _YEAR)


def send_to_play(response: Response) -> None:
    """The arena's login page, which comes next, need not ask."""
    _keep(response, PLAY_COOKIE, "1", _SENT)


def _keep(response: Response, name: str, value: str, seconds: int) -> None:
    """It is no secret: arenas by http read and replace it, too."""
    response.set_cookie(name, value, max_age=seconds, domain=_sharing().domain, path="/", samesite="Lax")


def _sharing() -> Sharing:
    return sharing(current_app.config[DOMAIN], request_host())
