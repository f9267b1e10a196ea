"""What a browser may do with the arena's pages: the headers that go with each answer to a request for some Host."""

import re

_LABEL = r"[A-Za-z0-9_](?:[A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?"
_NAME = re.compile(rf"({_LABEL}(?:\.{_LABEL})*\.?)(?::[0-9]{{1,5}})?")
_IPV6 = re.compile(r"\[[0-9A-Fa-f:.]{2,45}\](?::[0-9]{1,5})?")
_MAX_HOST = 260  # characters, the port included


def is_host(host: str) -> bool:
    """Whether that can stand in a header Host: a name, an IPv4 address or an IPv6 address in brackets; with a port."""
    return len(host) <= _MAX_HOST and bool(_NAME.fullmatch(host) or _IPV6.fullmatch(host))


def page_policy(host: str, rosbridge_port: int) -> str:
    """The Content-Security-Policy of the arena's pages at `host`, which `is_host`.

    They talk to the arena and to rosbridge, show pictures of the game's pages, and stand in frames of these: all at the
    same host name. The policy's grammar has no IPv6 addresses: for one, only the scheme tells what is allowed.
    """
    if match := _NAME.fullmatch(host):
        name = match[1]
        sockets = f"ws://{host} wss://{host} ws://{name}:{rosbridge_port} wss://{name}:{rosbridge_port}"
        pages = f"http://{name}:* https://{name}:*"
    else:
        sockets, pages = "ws: wss:", "http: https:"
    return (
        f"default-src 'self'; connect-src 'self' {sockets}; img-src 'self' {pages}; object-src 'none'; "
        f"base-uri 'none'; form-action 'none'; frame-ancestors 'self' {pages}"
    )
