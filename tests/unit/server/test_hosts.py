"""What may stand in the header Host."""

import pytest

from server.web.hosts import is_valid_host


@pytest.mark.parametrize(
    "host",
    [
        "laser_bot_master.local",
        "laser_bot_master.local:5000",
        "localhost",
        "127.0.0.1:1",
        "[::1]",
        "[fe80::1]:65535",
        "a.",
        "x" * 63,
        "xn--caf-dma.example",
    ],
)
def test_names_and_addresses(host: str) -> None:
    assert is_valid_host(host)


@pytest.mark.parametrize(
    "host",
    ["", " ", ".", "-a", "a:", "a:b", "a..b", "a b", "a/b", "a@b", "a,b", "a\n", "%00", "::1", "[::1", "[zz]", "xn--a"],
)
def test_anything_else_is_none(host: str) -> None:
    assert not is_valid_host(host)


@pytest.mark.parametrize("host", ["x" * 64, ".".join(["x" * 60] * 5), "a:99999999", "\xe9", "\u0661"])
def test_what_is_too_long_or_not_in_ascii_is_none(host: str) -> None:
    assert not is_valid_host(host)
