"""Where a camera may be."""

import pytest

from server.camera.multipart import StreamError
from server.camera.stream import Address, address_of, stream_of


@pytest.mark.parametrize(
    ("value", "address"),
    [
        ("http://192.168.1.21:8090", Address("192.168.1.21", 8090, "/stream?extra_headers=1")),
        ("http://raspberrypi1.local:8090/", Address("raspberrypi1.local", 8090, "/stream?extra_headers=1")),
        ("http://127.0.0.1:8080/eyes/virtual0", Address("127.0.0.1", 8080, "/eyes/virtual0/stream?extra_headers=1")),
        ("http://[fe80::1]:80/a-b/c.d", Address("fe80::1", 80, "/a-b/c.d/stream?extra_headers=1")),
    ],
)
def test_an_address(value: str, address: Address) -> None:
    assert address_of(value) == address


@pytest.mark.parametrize(
    "value",
    [
        "", None, 8090, ["http://1.2.3.4:80"], "http://1.2.3.4", "https://1.2.3.4:80", "http://u:p@1.2.3.4:80",
        "http://1.2.3.4:0", "http://1.2.3.4:65536", "http://1.2.3.4:80/a?b", "http://1.2.3.4:80/a b", "file:///etc",
        "http://1.2.3.4:80/\r\nX: y", "http://1.2.3.4:80\n", "http://é:80", "http://h:80/" + "x" * 300,
    ],
)  # fmt: skip
def test_what_is_no_address(value: object) -> None:
    with pytest.raises(StreamError, match="the robot tells a wrong address of its camera"):
        address_of(value)


@pytest.mark.parametrize(
    "url",
    [
        "http://192.168.1.30:8090/stream?extra_headers=1",
        "http://cam:81/a/b.mjpg?fps=5&q=80%25",
        "http://[fe80::1]:80/x",
    ],
)
def test_the_whole_address_of_a_stream(url: str) -> None:
    address = stream_of(url)
    assert address
    assert address.url == url


@pytest.mark.parametrize(
    "value", ["", None, "http://1.2.3.4/x", "http://h:80/a b", "http://h:80/\r\nX: y", "ftp://h:80/x", "http://h:0/x"]
)
def test_what_is_no_stream(value: object) -> None:
    assert stream_of(value) is None


def test_a_rate_stands_in_the_query() -> None:
    eyes, above = Address("a", 1, "/eyes/a/stream?extra_headers=1"), Address("a", 1, "/overhead/stream")
    assert eyes.at(5).target == "/eyes/a/stream?extra_headers=1&rate=5"
    assert above.at(7).target == "/overhead/stream?rate=7"
    assert eyes.at(0) == eyes
