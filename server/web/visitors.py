"""Where a request comes from, and how often one address may sign up."""

import hashlib
import hmac
import secrets
import time
from ipaddress import ip_address

from flask import request

from laser_bot_battle.token_bucket import TokenBuckets

AT_ONCE = 4  # sign-ups of one address, then
PERIOD = 3.0  # s for each further one

_THIS_MACHINE = ("127.0.0.1", "::1")
_SALT = secrets.token_bytes(16)
_FORWARDED = "X-Forwarded-For"  # a list to which each proxy adds whose request it passes on


def visitor_address() -> str:
    """The visitor's, also behind a proxy on this machine; what others say of themselves is not believed."""
    peer = request.remote_addr or ""
    if not _is_proxied():
        return peer
    try:
        return str(ip_address(request.headers[_FORWARDED].rpartition(",")[2].strip()))
    except ValueError:
        return peer


def visitor_mark() -> str:
    """What stands for the visitor's address in what is kept: it tells addresses apart, and nobody which they are."""
    return hmac.new(_SALT, visitor_address().encode(), hashlib.sha256).hexdigest()[:16]


class SignUps:
    """Sign-ups by address. Who plays on this machine itself, as in a demo, waits for nothing."""

    def __init__(self) -> None:
        self._buckets = TokenBuckets(AT_ONCE, PERIOD)

    def wait(self) -> float:
        """Count the request as a sign-up, or (not 0) return the s until there may be one from its address."""
        if request.remote_addr in _THIS_MACHINE and not _is_proxied():
            return 0.0
        return self._buckets.take(visitor_address(), time.monotonic())


def _is_proxied() -> bool:
    return request.remote_addr in _THIS_MACHINE and _FORWARDED in request.headers
