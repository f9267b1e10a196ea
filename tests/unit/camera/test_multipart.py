"""A camera's stream, taken apart."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from server.camera.multipart import MAX_BODY, MAX_HEAD, Part, Parts, StreamError, boundary_of
from tests.unit.camera.parts import BOUNDARY, HEAD, JPEG, part

STREAM = part() + part(b"") + part(b"\r\n--\r\n", X_UStreamer_Online="false") + b"--" + BOUNDARY


def bodies(*pieces: bytes) -> list[bytes]:
    parts = Parts(BOUNDARY)
    return [one.body for piece in pieces for one in parts.feed(piece)]


def test_the_answer_of_ustreamer_names_its_boundary() -> None:
    assert boundary_of(HEAD) == BOUNDARY


@pytest.mark.parametrize(
    ("head", "reason"),
    [
        (b"HTTP/1.0 403 Refused\r\n\r\n", "the camera answers 403 Refused"),
        (b"HTTP/1.0 503 \x1b[2J" + b"x" * 500 + b"\r\n\r\n", r"the camera answers 503 \?\[2J"),
        (b"HTTP/1.0 200 OK\r\nContent-Type: image/jpeg\r\n\r\n", "something else than a stream"),
        (b"HTTP/1.0 200 OK\r\n\r\n", "something else than a stream"),
        (b"HTTP/1.0 200 OK\r\nwhat\r\n\r\n", "garbage"),
        (b"SSH-2.0-OpenSSH\r\n\r\n", "no camera"),
    ],
)
def test_another_answer_is_refused_with_the_reason(head: bytes, reason: str) -> None:
    with pytest.raises(StreamError, match=reason) as error:
        boundary_of(head)
    assert len(str(error.value)) < 100


def test_a_part_has_its_headers_and_its_body() -> None:
    headers = {"content-type": "image/jpeg", "content-length": str(len(JPEG)), "x-timestamp": "1795545856.456000"}
    assert Parts(BOUNDARY).feed(part()) == [Part(headers, JPEG)]


@pytest.mark.parametrize("at", range(len(STREAM)))
def test_it_does_not_matter_where_the_stream_is_split(at: int) -> None:
    assert bodies(STREAM[:at], STREAM[at:]) == [JPEG, b"", b"\r\n--\r\n"]


def test_byte_by_byte_it_is_the_same() -> None:
    assert bodies(*(bytes([byte]) for byte in STREAM)) == [JPEG, b"", b"\r\n--\r\n"]


@given(st.lists(st.binary(max_size=200)), st.integers(1, 300))
def test_any_bodies_in_any_pieces_come_out_as_they_went_in(sent: list[bytes], size: int) -> None:
    stream = b"".join(map(part, sent))
    assert bodies(*(stream[at : at + size] for at in range(0, len(stream), size))) == sent


@given(st.binary(max_size=300))
def test_garbage_is_an_error_or_waits_for_more(data: bytes) -> None:
    parts = Parts(BOUNDARY)
    try:
        parts.feed(data)
    except StreamError as error:
        assert "the camera" in str(error)


@pytest.mark.parametrize(
    ("stream", "reason"),
    [
        (b"x", "garbage between"),
        (part() + b"GET", "garbage between"),
        (b"--another\r\n", "garbage between"),
        (b"--" + BOUNDARY + b"--\r\n", "garbage between"),
        (part(Content_Length=None), "how long"),
        (part(Content_Length="-1"), "how long"),
        (part(Content_Length="9" * 30), "how long"),
        (part(Content_Length=MAX_BODY + 1), f"{MAX_BODY} are allowed"),
        (part(X=b"x" * MAX_HEAD), "too long a head"),
        (b"--" + BOUNDARY + b"\r\nno colon\r\n\r\n", "garbage"),
    ],
)
def test_what_is_no_part_is_an_error(stream: bytes, reason: str) -> None:
    with pytest.raises(StreamError, match=reason):
        bodies(stream)


def test_the_largest_part_is_taken() -> None:
    body = bytes(MAX_BODY)
    assert bodies(part(body)) == [body]
