"""What a browser may do with the arena's pages: the headers that go with each answer to a request for some Host."""

import re

_LABEL = r"[A-Za-z0-9_](?:[A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?"
_HOST = re.compile(rf"(?P<name>{_LABEL}(?:\.{_LABEL})*\.?|\[[0-9A-Fa-f:.]{{2,45}}\])(?::(?P<port>[0-9]{{1,5}}))?")
_MAX_HOST = 260  # characters, the port included


def is_host(host: str) -> bool:
    """Whether that can stand in a header Host: a name, an IPv4 address or an IPv6 address in brackets; with a port."""
    return len(host) <= _MAX_HOST and _HOST.fullmatch(host) is not None


def page_policy(host: str, rosbridge_port: int) -> str:
    """The Content-Security-Policy of the arena's pages at `host`, which `is_host`.

    They talk to the arena and to rosbridge, show pictures of the game's pages, and stand in frames of these: all at the
    same host name. The policy's grammar has no underscores (laser_bot_master.local) and no IPv6 addresses, and browsers
    pass over a source that has them: for such a host, only ports and schemes tell what is allowed.
    """
    match = _HOST.fullmatch(host)
    assert match
    name = match["name"]
    can_be_named = "_" not in name and "[" not in name
    place = name if can_be_named else "*"
    ports = (f":{match['port']}" if match["port"] else "", f":{rosbridge_port}")
    sockets = " ".join(f"{scheme}://{place}{port}" for port in ports for scheme in ("ws", "wss"))
    pages = f"http://{name}:* https://{name}:*" if can_be_named else "http: https:"
    return (
        f"default-src 'self'; connect-src 'self' {sockets}; img-src 'self' {pages}; object-src 'none'; "
        f"base-uri 'none'; form-action 'none'; frame-ancestors 'self' {pages}"
    )
