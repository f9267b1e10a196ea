"""What a browser may do with the arena's pages."""

import pytest

from sim.arena.policy import page_policy


def directive(policy: str, name: str) -> set[str]:
    (found,) = [part.split()[1:] for part in policy.split("; ") if part.split()[0] == name]
    return set(found)


def test_everything_stays_on_the_host_that_was_asked() -> None:
    policy = page_policy("hall.local:8080", 9091)
    assert directive(policy, "default-src") == {"'self'"}
    sockets = {"ws://hall.local:8080", "wss://hall.local:8080", "ws://hall.local:9091", "wss://hall.local:9091"}
    assert directive(policy, "connect-src") == {"'self'", *sockets}
    pages = {"'self'", "http://hall.local:*", "https://hall.local:*"}
    assert directive(policy, "img-src") == directive(policy, "frame-ancestors") == pages


@pytest.mark.parametrize(("host", "name"), [("localhost", "localhost"), ("10.0.0.9:8080", "10.0.0.9")])
def test_the_host_is_known_by_its_name_without_the_port(host: str, name: str) -> None:
    assert f"http://{name}:*" in directive(page_policy(host, 9090), "frame-ancestors")


@pytest.mark.parametrize("host", ["[::1]", "laser_bot_master.local"])
def test_a_host_that_browsers_do_not_take_in_a_policy_is_told_by_ports_and_schemes(host: str) -> None:
    policy = page_policy(f"{host}:8080", 9091)
    sockets = {"ws://*:8080", "wss://*:8080", "ws://*:9091", "wss://*:9091"}
    assert directive(policy, "connect-src") == {"'self'", *sockets}
    assert directive(policy, "img-src") == directive(policy, "frame-ancestors") == {"'self'", "http:", "https:"}
    assert host not in policy
