"""Free TCP ports on the loopback interface."""

import socket


def free_port() -> int:
    """A port that nothing listens on now. The kernel hands out another one next time."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def listening(port: int) -> bool:
    """Whether something accepts connections at the port now."""
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0
