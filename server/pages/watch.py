"""The screen for spectators."""

from datetime import datetime
from functools import lru_cache
from ipaddress import ip_address
from urllib.parse import urlsplit

import segno
from flask import Blueprint, render_template, request
from markupsafe import Markup

from laser_bot_battle.addresses import reachable_addresses
from server.web.hosts import request_host
from server.web.settings import Settings


def create_watch(settings: Settings) -> Blueprint:
    """The route, as a Flask blueprint."""
    pages = Blueprint("watch", __name__)

    @pages.get("/watch")
    def watch() -> str:
        address = players_address(request.scheme, request_host(), settings.program.bind, settings.program.port)
        return render_template("watch.html", address=address, code=_qr_code(address), utc_offset=_utc_offset())

    return pages


def players_address(scheme: str, host: str, bind: str, port: int) -> str:
    """Where players reach the game: as the spectator does, `host` (with its port), unless that leads to this machine
    only. Then one of this machine's own addresses, if the server listens there: `bind`, `port`."""
    if _is_loopback(urlsplit(f"//{host}").hostname or ""):
        reachable = reachable_addresses(bind)
        if reachable:
            return f"http://{reachable[0].ip}:{port}"
    return f"{scheme}://{host}"


def _is_loopback(name: str) -> bool:
    try:
        address = ip_address(name)
    except ValueError:
        return name == "localhost" or name.endswith(".localhost")
    return address.is_loopback or address.is_unspecified


@lru_cache(100)
def _qr_code(text: str) -> Markup:
    """As SVG, black on white in any theme: that is what cameras read."""
    code = segno.make(text, micro=False, error="m")
    return Markup(code.svg_inline(border=4, dark="#000", light="#fff", omitsize=True, svgclass=None, lineclass=None))


def _utc_offset() -> int:
    """Of this machine's time zone now, in minutes: the leaderboard's days are the server's."""
    offset = datetime.now().astimezone().utcoffset()
    return int(offset.total_seconds() // 60) if offset else 0
