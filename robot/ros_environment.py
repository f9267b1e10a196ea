"""What ROS reads from the environment, completed where nothing is set."""

import socket
from collections.abc import Mapping
from urllib.parse import urlsplit


def ros_environment(env: Mapping[str, str], master_uri: str) -> dict[str, str]:
    """The variables to add to `env`: ROS_MASTER_URI, and ROS_IP unless an own address is set.

    Without an address ROS tells others this machine's host name, which they often cannot resolve. The address that
    they reach us at is the one on our side of the route to the master. OSError if the master's name is unknown.
    """
    added = {"ROS_MASTER_URI": master_uri}
    if not env.get("ROS_IP") and not env.get("ROS_HOSTNAME"):
        url = urlsplit(master_uri)
        added["ROS_IP"] = local_address(url.hostname or "", url.port or 0)
    return added


def local_address(host: str, port: int) -> str:
    """This machine's IPv4 address on the route to `host`; nothing is sent. OSError if there is no route."""
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect((host, port))
            return str(probe.getsockname()[0])
    except OSError as error:
        raise OSError(f"cannot reach the ROS master at {host}: {error.strerror or error}") from None
