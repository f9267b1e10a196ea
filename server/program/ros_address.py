"""The address by which ROS tells others where the master's nodes are, where neither ROS_IP nor ROS_HOSTNAME says it.

The robots reach the game and rosbridge by it, so it must be one of this machine's in their network.
"""

import ipaddress
import logging
import os
import threading
from collections.abc import Callable

from laser_bot_battle.addresses import lan_choice, own_addresses, reachable_addresses
from laser_bot_battle.ros_environment import address_towards, has_address

LOOPBACK = "127.0.0.1"
PERIOD = 1.0  # s between two looks at this machine's addresses

_log = logging.getLogger(__name__)


def settle(bind: str, master_uri: str, ending: threading.Event, on_change: Callable[[str], None]) -> None:
    """Set ROS_IP unless an address is set; call `on_change` when it is no longer right, until `ending`.

    `bind` is where this program listens for players. OSError if there is no way to the ROS master.
    """
    if not os.environ.get("ROS_HOSTNAME"):
        os.environ.pop("ROS_HOSTNAME", None)  # ROS takes an empty one before ROS_IP
    if has_address(os.environ):
        return
    chosen = choose(bind, master_uri)
    os.environ["ROS_IP"] = chosen
    _log.info("ROS finds this program at %s; its networks: %s (LASERBOT_INTERFACE chooses)", chosen, lan_choice())

    def watch() -> None:
        while not ending.wait(PERIOD):
            better = successor(chosen, bind, master_uri)
            if better:
                on_change(f"ROS was told the address {chosen}, and this machine now has {better}")

    threading.Thread(target=watch, name="own address", daemon=True).start()


def choose(bind: str, master_uri: str) -> str:
    """This machine's address for ROS: with the ROS master on it, one that robots reach, if they are to reach it at all.

    OSError if there is no way to the ROS master.
    """
    towards_master = address_towards(master_uri)
    if not ipaddress.ip_address(towards_master).is_loopback:
        return towards_master
    reachable = reachable_addresses(bind)
    return reachable[0].ip if reachable else LOOPBACK


def successor(chosen: str, bind: str, master_uri: str) -> str | None:
    """The address that now takes the place of `chosen`; None as long as that is right, or there is no other.

    It stays right while this machine has it, but loopback only until there is a network.
    """
    if chosen != LOOPBACK and chosen in own_addresses():
        return None
    try:
        now = choose(bind, master_uri)
    except OSError:  # there is no network now
        return None
    return now if now not in (chosen, LOOPBACK) else None
