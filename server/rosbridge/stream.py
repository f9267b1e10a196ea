"""A client's requests in what it sends: JSON objects, however they are cut into WebSocket messages. Pure.

Upstream's server scans for whole objects, and clients have come to rely on it: several of them in one message, one over
several, line ends, NULs or a byte order mark around them, text in binary messages. What is none is skipped up to the
next brace that may begin one, in time that grows with its length only.
"""

import codecs
import re
from typing import Any

from server.websocket.requests import RequestError, brief, parse

AROUND = "\ufeff\0\x1e \t\r\n"  # may stand between requests
_TOKEN = re.compile(r'["{}\[\]]|[^"{}\[\]]+')
_IN_STRING = re.compile(r'(?:[^"\\]+|\\.)*', re.DOTALL)
_SPACE = " \t\r\n"
# what may stand before a value's beginning, by the last character that counts; "v" stands for a number or a word
_BEFORE_VALUE = {":", ",", "["}
_AFTER_VALUE = {'"', "}", "]"}
_ENDS = {"}": "{", "]": "["}

Found = dict[str, Any] | str | RequestError  # a request, the text of a long one, or why something is none


class RequestStream:
    """Of one client."""

    def __init__(self, limit: int, long: int) -> None:
        """`limit`: characters that may wait for the rest of their request; `long`: texts of more are not read here."""
        self.limit, self._long = limit, long
        self._bytes = _utf8()
        self._told = False  # that something has been skipped since the last request
        self._text = ""
        self._begin(0)

    def _begin(self, start: int) -> None:
        """What comes next is the text from there on, of which nothing has been looked at."""
        self._start = self._at = start  # looked at so far
        self._open: list[str] = []  # brackets
        self._last = ""  # character that counts
        self._string = -1  # where the last string begins
        self._in_string = False
        self._is_fault = False  # what has been looked at cannot be a request

    @property
    def waits(self) -> int:
        """Characters that wait for the rest of their request."""
        return len(self._text)

    def whole(self, data: str | bytes) -> dict[str, Any] | None:
        """The request, if `data` is exactly one, and not long: the usual case, and the quickest."""
        if self._text or len(data) > self._long or not isinstance(data, str):
            return None
        try:
            fields = parse(data)
        except RequestError:
            return None
        return self._request(fields) if "op" in fields else None

    def feed(self, data: str | bytes) -> list[Found]:
        """What has become complete, in order."""
        found: list[Found] = []
        self._text += data if isinstance(data, str) else self._decoded(data, found)
        while self._find(found):
            pass
        self._forget(self._start)
        if len(self._text) > self.limit:
            self._begin(len(self._text))
            self._forget(len(self._text))
            found.append(RequestError(f"a request does not end within {self.limit} characters"))
        return found

    def _forget(self, end: int) -> None:
        """The text up to there."""
        self._text = self._text[end:]
        self._start -= end
        self._at -= end
        self._string -= end

    def _decoded(self, data: bytes, found: list[Found]) -> str:
        try:
            return self._bytes.decode(data)
        except UnicodeDecodeError:
            self._bytes = _utf8()
            self._text = ""
            self._begin(0)
            self._skip("binary data that is not UTF-8", found)
            return ""

    def _request(self, fields: dict[str, Any]) -> dict[str, Any]:
        self._told = False
        return fields

    def _skip(self, text: str, found: list[Found]) -> None:
        text = text.strip(AROUND)
        if text and not self._told:
            self._told = True
            found.append(RequestError(f"a request is a JSON object with an op; skipped {brief(text)}"))

    def _find(self, found: list[Found]) -> bool:
        """Look on. Whether something was found, or skipped."""
        if not self._open:
            brace = self._text.find("{", self._start)
            begin = brace if brace >= 0 else len(self._text)
            self._skip(self._text[self._start : begin], found)
            self._begin(begin)
            if brace < 0:
                return False
        end = self._look()
        if end is None:
            return False
        whole = self._text[self._start : end]
        if self._is_fault:
            self._skip(whole, found)
        elif len(whole) > self._long:
            self._told = False
            found.append(whole)
        else:
            try:
                fields = parse(whole)
            except RequestError as error:
                found.append(error)
            else:
                if "op" in fields:
                    found.append(self._request(fields))
                else:  # behind a list that was cut there may be thousands: an answer to each would be a flood
                    self._skip(whole, found)
        self._begin(end)
        return True

    def _look(self) -> int | None:
        """Where the object ends, or what cannot be one; None: not yet known."""
        while self._at < len(self._text):
            if self._in_string:
                self._at = _end(_IN_STRING, self._text, self._at)
                if self._at == len(self._text) or self._text[self._at] == "\\":
                    return None  # an escape may have been cut
                self._at += 1
                self._in_string, self._last = False, '"'
                continue
            start, self._at = self._at, _end(_TOKEN, self._text, self._at)
            if not self._takes(self._text[start : self._at], start):
                self._is_fault = True
                # what seemed a string may have been the end of one that was cut, and a request
                return self._string + 1 if self._last == '"' else start
            if not self._open:
                return self._at
        return None

    def _takes(self, token: str, start: int) -> bool:
        """Whether an object can go on like this."""
        last = self._last
        match token:
            case "{" | "[":
                fits = not self._open or last in _BEFORE_VALUE
                self._open.append(token)
            case "}" | "]":
                fits = self._open.pop() == _ENDS[token]
            case '"':
                fits = last in _BEFORE_VALUE or last == "{"
                self._string, self._in_string = start, fits
            case _:
                token = token.strip(_SPACE)
                if not token:
                    return True
                fits = last != "{" and (last not in _AFTER_VALUE or token[0] in ",:")
                token = token[-1] if token[-1] in ",:" else "v"
        self._last = token if fits else last
        return fits


def _utf8() -> codecs.IncrementalDecoder:
    return codecs.getincrementaldecoder("utf-8")()


def _end(pattern: re.Pattern[str], text: str, start: int) -> int:
    match = pattern.match(text, start)
    assert match is not None
    return match.end()
