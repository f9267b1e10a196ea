"""Who opens a WebSocket: the session cookie in the handshake, if the page that sends it is one of ours."""

import socket

from rosgraph.network import get_host_name

from laser_bot_battle.names import SESSION_COOKIES
from server.access.identity import FOREIGN_GUEST, GUEST, Identity, session_identity
from server.access.own_pages import PageAddresses, Standing


class OwnPages(PageAddresses):
    """The game's pages, which act for whoever looks at them."""

    def identity_of(self, origin: str | None, authority: str | None, cookies: list[str]) -> Identity:
        """The identity by the values of the handshake's headers Origin, Host and Cookie; a believed proxy's word counts
        in place of Host's (`PageAddresses.standing`).

        A browser sends our cookie whatever page opens the WebSocket. A page that is not the game's must not act for the
        player, so its cookie is ignored. Programs that send no Origin choose their cookies themselves.
        """
        if origin is not None and self.standing(origin, authority) is not Standing.OWN:
            return FOREIGN_GUEST
        token = session_token(cookies)
        return session_identity(token) if token else GUEST


def session_token(cookies: list[str]) -> str:
    """What the handshake's Cookie headers hold for us; empty without it. Of two of a name the first, which has the
    longer path.

    The token has nothing to escape, and a library for those would cost this program 4.5 MB of memory.
    """
    pairs = [pair.strip().partition("=") for header in cookies for pair in header.split(";")]
    found = (value.strip('"') for wanted in SESSION_COOKIES for name, _, value in pairs if name == wanted)
    return next(found, "")


def own_names() -> set[str]:
    """This machine's name for itself, and the one by which ROS finds it."""
    return {socket.gethostname(), str(get_host_name())}
