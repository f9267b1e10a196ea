"""Cookies that several arenas and their entrance share: by a domain above all their hosts, or by one host with many
ports, since cookies ignore ports."""

import ipaddress
import re
from typing import NamedTuple
from urllib.parse import urlsplit

EVERY_PORT = "*"  # in place of a domain: whatever host is asked
_TOKEN = re.compile(r"[A-Za-z0-9_-]{43}")  # as secrets.token_urlsafe(32) makes them


class Sharing(NamedTuple):
    """How the cookies of one visitor are shared."""

    is_shared: bool
    domain: str | None  # the cookies' attribute; None: they are the host's alone, at all its ports


ALONE = Sharing(False, None)


def sharing(domain: str, host: str) -> Sharing:
    """Of whoever asks `host` (perhaps with a port), where LASERBOT_DOMAIN is `domain`.

    At an address that is not below the domain, such as that of the machine itself, nothing is shared.
    """
    name = _name(host)
    if not domain or not name:
        return ALONE
    if domain == EVERY_PORT:
        return Sharing(True, None)
    if name != domain and not name.endswith(f".{domain}"):
        return ALONE
    return Sharing(True, None if "." not in domain or _is_address(domain) else domain)  # browsers take no other one


def is_token(text: str) -> bool:
    """Whether it can be a session's token: what is shorter could be guessed."""
    return _TOKEN.fullmatch(text) is not None


def _name(host: str) -> str:
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


def _is_address(text: str) -> bool:
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True
