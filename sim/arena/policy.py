"""What a browser may do with the arena's pages: the Content-Security-Policy for a request to some Host."""

from laser_bot_battle.hosts import policy_source


def page_policy(host: str, rosbridge_port: int) -> str:
    """The policy of the arena's pages at `host`, which is a valid one.

    They talk to the arena and to rosbridge, show pictures of the game's pages, and stand in frames of these: all at the
    same host name. Where a policy cannot name that, only ports and schemes tell what is allowed.
    """
    name, port = policy_source(host)
    ports = (port, f":{rosbridge_port}")
    sockets = " ".join(f"{scheme}://{name}{port}" for port in ports for scheme in ("ws", "wss"))
    pages = "http: https:" if name == "*" else f"http://{name}:* https://{name}:*"
    return (
        f"default-src 'self'; connect-src 'self' {sockets}; img-src 'self' {pages}; object-src 'none'; "
        f"base-uri 'none'; form-action 'none'; frame-ancestors 'self' {pages}"
    )
