"""The header Host of a request: whether it names a host, and what a Content-Security-Policy can say of that."""

import codecs
import re

codecs.lookup("idna")  # its first use loads it: if no file can be opened at that moment, it may stay unknown

_LABEL = r"[A-Za-z0-9_](?:[A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?"
_HOST = re.compile(rf"(?P<name>{_LABEL}(?:\.{_LABEL})*\.?|\[[0-9A-Fa-f:.]{{2,45}}\])(?::(?P<port>[0-9]{{1,5}}))?")
_MAX_HOST = 260  # characters, the port included


def is_valid_host(host: str) -> bool:
    """Whether that can stand in a header Host: a name, an IPv4 address or an IPv6 address in brackets; with a port."""
    try:
        host.encode("ascii").decode("idna")
    except UnicodeError:
        return False
    return len(host) <= _MAX_HOST and _HOST.fullmatch(host) is not None


def policy_source(host: str) -> tuple[str, str]:
    """The host's name as a policy can have it, and its port (":8080" or empty). ValueError: it is no valid host.

    The policy's grammar has no underscores (laser_bot_master.local) and no IPv6 addresses, and browsers pass over a
    source that has them: the name of such a host is "*", which allows each.
    """
    match = _HOST.fullmatch(host)
    if match is None:
        raise ValueError(f"{host[:80]!r} is no host")
    name, port = match["name"], f":{match['port']}" if match["port"] else ""
    return ("*" if "_" in name or "[" in name else name), port
