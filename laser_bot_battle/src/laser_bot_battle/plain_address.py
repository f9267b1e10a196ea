"""An address of IPv4 as such, where a socket for both families calls it ::ffff:1.2.3.4."""

from contextlib import suppress
from ipaddress import IPv6Address, ip_address


def plain_address(address: str) -> str:
    """The address as all compare and count it; what is no address stays as it is."""
    if ":" in address:
        with suppress(ValueError):
            parsed = ip_address(address)
            if isinstance(parsed, IPv6Address) and parsed.ipv4_mapped:
                return str(parsed.ipv4_mapped)
    return address
