"""How many sockets anybody may have. Pure."""

from collections import Counter
from collections.abc import Hashable
from typing import NamedTuple

from laser_bot_battle.openings import MOST, OF_ADDRESS
from server.access.identity import Identity


class Limits(NamedTuple):
    """Numbers of sockets."""

    clients: int = 1000
    kept: int = 200  # of them, for players and operators
    guests: int = OF_ADDRESS  # of one address
    player: int = 20  # of one player
    opening: int = OF_ADDRESS  # of one address whose handshake is not finished
    all_opening: int = MOST


class SocketOwner(NamedTuple):
    """Who has a socket: `holder` is an address for a guest, a session for a player, None for an operator."""

    known: bool
    holder: Hashable


class SocketLimits:
    """The sockets that are open, by owner."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self._taken: Counter[SocketOwner] = Counter()
        self._clients = self._guests = 0

    def refusal(self, owner: SocketOwner) -> str:
        """Why this owner can have no further socket; empty when it can."""
        if not owner.known:
            if self._taken[owner] >= self.limits.guests:
                return f"{owner.holder} has {self.limits.guests} sockets already"
            if self._guests >= self.limits.clients - self.limits.kept:
                return f"{self._guests} guests are connected"
        elif owner.holder is not None and self._taken[owner] >= self.limits.player:
            return f"a player has {self.limits.player} sockets already"
        return f"{self._clients} clients are connected" if self._clients >= self.limits.clients else ""

    def take(self, owner: SocketOwner) -> None:
        self._count(owner, 1)

    def leave(self, owner: SocketOwner) -> None:
        self._count(owner, -1)

    def change(self, old: SocketOwner, new: SocketOwner) -> SocketOwner:
        """An owner has turned out to be another one: the owner from now on, the old one if the new can have no more.

        Nobody is refused for ceasing to be a player.
        """
        self.leave(old)
        owner = old if new.known and self.refusal(new) else new
        self.take(owner)
        return owner

    def _count(self, owner: SocketOwner, step: int) -> None:
        self._clients += step
        self._guests += 0 if owner.known else step
        self._taken[owner] += step
        if not self._taken[owner]:
            del self._taken[owner]


def owner_of(identity: Identity, is_player: bool, address: str) -> SocketOwner:
    """The owner that this identity is; `is_player`: it is signed in now."""
    if identity.operator:
        return SocketOwner(True, None)
    return SocketOwner(True, identity.session) if is_player else SocketOwner(False, address)
