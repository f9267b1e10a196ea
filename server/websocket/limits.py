"""How many sockets who may have. Pure."""

from collections import Counter
from collections.abc import Hashable
from typing import NamedTuple

from server.access.identity import Identity


class Limits(NamedTuple):
    """Numbers of sockets."""

    clients: int = 1000
    kept: int = 200  # of them, for players and operators
    guests: int = 50  # of one address
    player: int = 20  # of one player
    opening: int = 50  # of one address whose handshake is not finished
    all_opening: int = 200


class Place(NamedTuple):
    """What one socket takes: `holder` is an address for a guest, a session for a player, None for an operator."""

    known: bool
    holder: Hashable


class Places:
    """The sockets that are open, by who holds them."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._taken: Counter[Place] = Counter()
        self._clients = self._guests = 0

    def refusal(self, place: Place) -> str:
        """Why this place cannot be had; empty when it can."""
        if not place.known:
            if self._taken[place] >= self.limits.guests:
                return f"{place.holder} has {self.limits.guests} sockets already"
            if self._guests >= self.limits.clients - self.limits.kept:
                return f"{self._guests} guests are connected"
        elif place.holder is not None and self._taken[place] >= self.limits.player:
            return f"a player has {self.limits.player} sockets already"
        return f"{self._clients} clients are connected" if self._clients >= self.limits.clients else ""

    def take(self, place: Place) -> None:
        self._count(place, 1)

    def leave(self, place: Place) -> None:
        self._count(place, -1)

    def change(self, old: Place, new: Place) -> Place:
        """Somebody has become somebody else: the place that he has from now on, the old one if he cannot have the new.

        Nobody is refused for ceasing to be a player.
        """
        self.leave(old)
        place = old if new.known and self.refusal(new) else new
        self.take(place)
        return place

    def _count(self, place: Place, step: int) -> None:
        self._clients += step
        self._guests += 0 if place.known else step
        self._taken[place] += step
        if not self._taken[place]:
            del self._taken[place]


def place_of(identity: Identity, is_player: bool, address: str) -> Place:
    """The place of who this is; `is_player`: he is signed in now."""
    if identity.operator:
        return Place(True, None)
    return Place(True, identity.session) if is_player else Place(False, address)
