"""A camera's stream by HTTP: the answer's head, and then the parts of `multipart/x-mixed-replace` (RFC 2046, 5.1)."""

import re
from collections.abc import Mapping
from typing import NamedTuple

MAX_HEAD = 4 * 2**10  # bytes of the answer's head, and of a part's
MAX_BODY = 2**20  # bytes of a part

_NUMBER = re.compile(r"[0-9]{1,9}")
_BOUNDARY = re.compile(r'multipart/x-mixed-replace\s*;\s*boundary="?([^\s";]{1,70})"?', re.IGNORECASE)
_HEAD_END = b"\r\n\r\n"


class StreamError(Exception):
    """What the camera sends is no stream of pictures; the text says why, for people."""


class Part(NamedTuple):
    headers: Mapping[str, str]  # by the name in lower case
    body: bytes


def boundary_of(head: bytes) -> bytes:
    """The boundary that the head of the camera's answer names. StreamError for an answer that is no stream."""
    status, _, fields = head.decode("latin-1").partition("\r\n")
    version, _, outcome = status.partition(" ")
    if not version.startswith("HTTP/1."):
        raise StreamError("what answers there is no camera")
    if not outcome.startswith("200"):
        raise StreamError(f"the camera answers {printable(outcome)}")
    match = _BOUNDARY.match(headers_of(fields).get("content-type", ""))
    if not match:
        raise StreamError("the camera sends something else than a stream of pictures")
    return match[1].encode("latin-1")


def headers_of(text: str) -> dict[str, str]:
    """Of lines `Name: value`. StreamError for a line that is none."""
    headers = {}
    for line in text.split("\r\n"):
        if line:
            name, colon, value = line.partition(":")
            if not colon:
                raise StreamError("the camera sends garbage")
            headers[name.lower()] = value.strip()
    return headers


class Parts:
    """The parts of one stream, which comes in pieces of any size. After a StreamError there are no more."""

    def __init__(self, boundary: bytes) -> None:
        self._start = b"--" + boundary + b"\r\n"
        self._buffer = bytearray()
        self._headers: Mapping[str, str] | None = None  # of the part whose body is to come
        self._length = 0  # of that body

    def feed(self, data: bytes) -> list[Part]:
        """The parts that `data` completes."""
        self._buffer += data
        parts = []
        while (part := self._next()) is not None:
            parts.append(part)
        return parts

    def _next(self) -> Part | None:
        if self._headers is None and not self._read_head():
            return None
        if self._headers is None or len(self._buffer) < self._length:
            return None
        part = Part(self._headers, bytes(self._buffer[: self._length]))
        del self._buffer[: self._length]
        self._headers = None
        return part

    def _read_head(self) -> bool:
        """Whether the next part's head is complete."""
        while self._buffer.startswith(b"\r\n"):  # it stands before a boundary, and belongs to it
            del self._buffer[:2]
        begin = self._buffer[: len(self._start)]
        if not self._start.startswith(begin) and begin != b"\r":
            raise StreamError("the camera sends garbage between its pictures")
        end = self._buffer.find(_HEAD_END, 0, MAX_HEAD)
        if end < 0:
            if len(self._buffer) >= MAX_HEAD:
                raise StreamError("the camera sends a picture with too long a head")
            return False
        headers = headers_of(self._buffer[len(self._start) : end].decode("latin-1"))
        length = headers.get("content-length", "")
        if not _NUMBER.fullmatch(length):
            raise StreamError("the camera does not tell how long a picture is")
        if int(length) > MAX_BODY:
            raise StreamError(f"the camera sends a picture of {length} bytes; {MAX_BODY} are allowed")
        self._headers, self._length = headers, int(length)
        del self._buffer[: end + len(_HEAD_END)]
        return True


def printable(text: str) -> str:
    """Text of a camera for a message to people: short, and in one line."""
    return "".join(char if char.isprintable() else "?" for char in text[:60])
