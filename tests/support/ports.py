"""Free TCP ports on the loopback interface."""

import socket


def free_port() -> int:
    """A port that nothing listens on, and that nobody else is given while this process lives.

    It stays bound here: the kernel hands it out to no one, and who sets SO_REUSEADDR, as servers do, may listen on it.
    """
    reservation = socket.socket()
    reservation.bind(("", 0))  # on all addresses, as servers do: clients have ports of their own at 127.0.0.2
    reservation.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    port = int(reservation.getsockname()[1])
    reservation.detach()
    return port


def listening(port: int) -> bool:
    """Whether something accepts connections at the port now."""
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0
