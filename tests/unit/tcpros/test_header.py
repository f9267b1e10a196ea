"""The header of a TCPROS connection."""

import pytest
import rosgraph.network

from tcpros.header import HeaderError, decode, encode

FIELDS = {"callerid": "/a", "md5sum": "*", "message_definition": "string a=b\nstring ü\n", "empty": ""}


def test_ros_reads_what_we_write_and_the_other_way_round() -> None:
    assert rosgraph.network.decode_ros_handshake_header(encode(FIELDS)) == FIELDS
    assert decode(rosgraph.network.encode_ros_handshake_header(FIELDS)[4:]) == FIELDS


def test_the_bytes_are_those_of_the_protocol() -> None:
    assert encode({"a": "b"}) == b"\x07\0\0\0" + b"\x03\0\0\0" + b"a=b"


@pytest.mark.parametrize(
    "block",
    [
        pytest.param(b"\x05\0\0", id="ends within a length"),
        pytest.param(b"\x05\0\0\0a=b", id="ends within a field"),
        pytest.param(b"\xff\xff\xff\xffa=b", id="a field of 4 GiB"),
        pytest.param(b"\x03\0\0\0abc", id="no ="),
        pytest.param(b"\0\0\0\0", id="empty field"),
        pytest.param(b"\x03\0\0\0a=\xff", id="no UTF-8"),
        pytest.param(b"GET / HTTP/1.1\r\n\r\n", id="HTTP"),
    ],
)
def test_what_is_no_header_is_refused(block: bytes) -> None:
    with pytest.raises(HeaderError):
        decode(block)
