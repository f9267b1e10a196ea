"""Parameters as JSON text."""

import xmlrpc.client
from typing import Any

import pytest

from server.rosapi.param_values import as_json, parameter
from server.websocket.requests import RequestError


@pytest.mark.parametrize("text", ["1", "-2147483648", "1.5", "true", '"a b"', "[1, [2.5]]", '{"a": {"b": []}}'])
def test_what_ros_can_hold_comes_back_the_same(text: str) -> None:
    assert as_json(parameter(text)) == text


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("hello", "a string needs quotes"),
        ("", "JSON"),
        ("[" * 100_000, "JSON"),
        ("null", "null cannot be"),
        ('{"a": [null]}', "null cannot be"),
        ("2147483648", "32 bits"),
        ("-2147483649", "32 bits"),
        ("1e999", "finite"),
        ("NaN", "finite"),
        (r'"\u0000"', "control characters"),
        (r'{"\u001b": 1}', "control characters"),
        (r'["\ud800"]', "control characters"),
        ("[" * 52 + "]" * 52, "inside each other"),
    ],
)
def test_what_ros_cannot_hold_is_refused(text: str, reason: str) -> None:
    with pytest.raises(RequestError, match=reason):
        parameter(text)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (float("nan"), "null"),
        ([float("-inf"), 1.0], "[null, 1.0]"),
        ({"picture": xmlrpc.client.Binary(b"\0\1")}, '{"picture": "AAE="}'),
        (xmlrpc.client.DateTime("20260102T03:04:05"), '"20260102T03:04:05"'),
    ],
)
def test_what_json_cannot_say_is_said_otherwise(value: Any, text: str) -> None:
    assert as_json(value) == text
