"""Where a request comes from, and how often one address may sign up."""

import hashlib
import hmac
import secrets
import time

from flask import Flask, current_app, request

from laser_bot_battle.names import is_bot
from laser_bot_battle.plain_address import plain_address
from laser_bot_battle.proxies import FORWARDED, THIS_MACHINE, visitor
from laser_bot_battle.token_bucket import TokenBuckets
from server.web.one_address import OneAddress

AT_ONCE = 4  # sign-ups of one address, then
PERIOD = 3.0  # s for each further one
BOTS_AT_ONCE = 32  # the same of bots, of which one machine may start many
BOTS_PERIOD = 1.0
VISITOR = "X-LaserBot-Visitor"  # to the process of the pages: the visitor's address, whatever the visitor says
PROXIES = "LASERBOT_PROXIES"  # in the application's configuration
_ONE_ADDRESS = "laserbot_one_address"  # among its extensions

_SALT = secrets.token_bytes(16)


def visitor_address() -> str:
    """The visitor's, also behind a proxy."""
    return visitor(request.remote_addr or "", request.headers.get(FORWARDED), current_app.config[PROXIES])


def is_secure() -> bool:
    """Whether the visitor's page came by TLS, which a proxy has ended; that may not say so."""
    return request.is_secure or request.headers.get("Origin", "").startswith("https://")


def is_this_machine() -> bool:
    """Whether a program on this machine asks for itself, not a proxy for others."""
    return plain_address(request.remote_addr or "") in THIS_MACHINE and FORWARDED not in request.headers


def visitor_mark() -> str:
    """What stands for the visitor's address in what is kept: it tells addresses apart, and nobody which they are."""
    return hmac.new(_SALT, visitor_address().encode(), hashlib.sha256).hexdigest()[:16]


def watch_addresses(app: Flask) -> None:
    """Let the application notice when most visitors seem to come from one address."""
    app.extensions[_ONE_ADDRESS] = OneAddress()


def one_address() -> OneAddress:
    """The application's."""
    found: OneAddress = current_app.extensions[_ONE_ADDRESS]
    return found


class SignUps:
    """Sign-ups by address. Visitors on this machine itself, as in a demo, wait for nothing.

    Bots and people of an address take nothing from each other. By its name, the game takes a bot's robot for any person
    who waits: that is no name for people who want to play, or to keep others from it.
    """

    def __init__(self) -> None:
        self._people, self._bots = TokenBuckets(AT_ONCE, PERIOD), TokenBuckets(BOTS_AT_ONCE, BOTS_PERIOD)

    def wait(self, name: str) -> float:
        """Count the request as a sign-up, or (not 0) return the s until there may be one from its address."""
        if not is_bot(name):
            one_address().came(name, visitor_address(), time.monotonic())
        if is_this_machine():
            return 0.0
        buckets = self._bots if is_bot(name) else self._people
        return buckets.take(visitor_address(), time.monotonic())
