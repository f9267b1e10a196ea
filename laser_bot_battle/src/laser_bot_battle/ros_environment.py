"""What ROS reads from the environment, completed where nothing is set."""

import ipaddress
import os
from collections.abc import Mapping
from urllib.parse import urlsplit

from laser_bot_battle import variables
from laser_bot_battle.addresses import lan_addresses, local_address


def ros_environment(env: Mapping[str, str], master_uri: str) -> dict[str, str]:
    """The variables to add to `env`: ROS_MASTER_URI, and ROS_IP unless an own address is set.

    Without an address ROS tells others this machine's host name, which they often cannot resolve. The address that
    they reach us at is the one on our side of the route to the master. OSError if the master's name is unknown.
    """
    added = {"ROS_MASTER_URI": master_uri}
    if not has_address(env):
        added["ROS_IP"] = address_towards(master_uri)
    return added


def has_address(env: Mapping[str, str]) -> bool:
    """Whether `env` says at which address others find this machine's nodes."""
    return bool(env.get("ROS_IP") or env.get("ROS_HOSTNAME"))


def address_towards(master_uri: str) -> str:
    """This machine's IPv4 address on the route to the master, or that of LASERBOT_INTERFACE unless the master is here.

    OSError if there is no route, or the name is unknown.
    """
    url = urlsplit(master_uri)
    try:
        towards = local_address(url.hostname or "", url.port or 0)
    except OSError as error:
        raise OSError(f"cannot reach the ROS master at {url.hostname}: {error.strerror or error}") from None
    if not variables.INTERFACE.read(os.environ) or ipaddress.ip_address(towards).is_loopback:
        return towards
    chosen = [address.ip for address in lan_addresses()]
    return towards if towards in chosen or not chosen else chosen[0]
