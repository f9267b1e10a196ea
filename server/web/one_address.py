"""Whether most visitors seem to come from one address: behind a proxy that does not say whose requests they are, or a
Kubernetes Service that replaces the address, all of them share what one address may have."""

import logging
import threading
from collections import Counter

from laser_bot_battle.proxies import THIS_MACHINE

MANY = 5  # people of one address are more than a family
SHARE = 0.75  # of all, that they must be: bots have addresses of their own
PERIOD = 3600.0  # s for which somebody is counted
MOST = 1000  # people that are remembered

_log = logging.getLogger(__name__)


class OneAddress:
    """Thread-safe. The time `now` is monotonic, in s."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._people: dict[str, tuple[str, float]] = {}  # address and time, by name; the oldest first
        self._told = ""

    def came(self, name: str, address: str, now: float) -> None:
        """Somebody wants to sign up."""
        with self._lock:
            self._people.pop(name, None)
            self._people[name] = (address, now)
            if len(self._people) > MOST:
                del self._people[next(iter(self._people))]
        found = self.found(now)
        if found and found != self._told:
            _log.warning(
                "most visitors seem to come from one address, %s: they share its limits of sign-ups and connections. "
                "Name a proxy there in LASERBOT_PROXIES; for a Service of Kubernetes, see k3s/README.md",
                found,
            )
        self._told = found

    def found(self, now: float) -> str:
        """The address; "" if visitors have their own."""
        with self._lock:
            addresses = Counter(address for address, time in self._people.values() if now - time < PERIOD)
        if not addresses:
            return ""
        ((address, count),) = addresses.most_common(1)
        is_one = count >= MANY and count >= SHARE * addresses.total() and address not in THIS_MACHINE
        return address if is_one else ""
