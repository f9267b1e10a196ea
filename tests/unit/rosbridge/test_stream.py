"""Requests in what a client sends, however it is cut."""

import json
from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from server.rosbridge import stream as stream_module
from server.rosbridge.stream import RequestStream
from server.websocket.requests import RequestError

LIMIT = 2**16

values = st.recursive(
    st.sampled_from([None, True, 1.5, -3, "", "}{", 'a\\\\"b', "é\\u2028", "]:,"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
    max_leaves=5,
)
requests = st.dictionaries(st.text(max_size=3), values, max_size=3).map(lambda fields: {**fields, "op": "x"})
between = st.text(alphabet="\ufeff\0\x1e \t\r\n", max_size=3)
places = st.lists(st.integers(0, 10**6), max_size=8)  # to cut at
rubbish = st.text(alphabet='abc{}[]":,\\1 ', max_size=12)


def stream() -> RequestStream:
    return RequestStream(LIMIT, LIMIT)


def shown(found: Sequence[object]) -> list[object]:
    return [str(each) if isinstance(each, RequestError) else each for each in found]


def answers(found: Sequence[object]) -> list[object]:
    """Without the words of errors: they quote what had come by then."""
    return ["an error" if isinstance(each, RequestError) else each for each in found]


def cut(whole: str | bytes, places: list[int]) -> list[str | bytes]:
    ends = [0, *sorted(place % (len(whole) + 1) for place in places), len(whole)]
    return [whole[start:end] for start, end in pairwise(ends)]


@given(
    st.lists(st.tuples(between, requests), max_size=4),
    between,
    places,
    st.booleans(),
)
def test_any_cutting_gives_the_same_requests(said, end, cuts, is_binary) -> None:
    text = "".join(before + json.dumps(request, ensure_ascii=is_binary) for before, request in said) + end
    whole = text.encode(errors="surrogatepass") if is_binary else text
    found = []
    reader = stream()
    for part in cut(whole, cuts):
        found += reader.feed(part)
    assert found == [json.loads(json.dumps(request)) for _, request in said]
    assert reader.waits == 0


@given(st.lists(st.one_of(rubbish, requests.map(json.dumps)), max_size=5), places)
def test_any_cutting_of_rubbish_gives_the_same_answers(said, cuts) -> None:
    text = "".join(said)
    whole, parts = stream(), stream()
    expected = whole.feed(text + '{"op": "end"}')
    found = [each for part in cut(text, cuts) for each in parts.feed(part)]
    assert answers([*found, *parts.feed('{"op": "end"}')]) == answers(expected)


REQUEST = '{"op": "publish", "msg": {"data": "}{\\"[x"}}'


@pytest.mark.parametrize(
    "rubbish_",
    [
        "hello",
        "5",
        "[1, 2]",
        '"text"',
        "}",
        "{",
        "{{",
        "]}[",
        "{broken",
        "{'op': 'publish'",
        '{"op"',
        '{"op": "publish"',
        '{"op": "publish", "topic": "/cut he',
        '{"op": "publish", "msg": {"data": [1, 2',
        '{"op": "publish"]',
        "\ufeff\0 ! ",
    ],
)
def test_a_request_behind_rubbish_is_found_and_the_rubbish_told_once(rubbish_: str) -> None:
    for whole in ([rubbish_ + REQUEST], [rubbish_, REQUEST], [*rubbish_, *REQUEST]):
        reader = stream()
        told = [each for part in whole for each in reader.feed(part)]
        *errors, request = told
        assert request == json.loads(REQUEST), whole
        assert len(errors) == 1, shown(errors)
        assert "skipped" in str(errors[0])


def test_objects_without_an_op_are_told_once() -> None:
    (error, request) = stream().feed("{}" * 1000 + REQUEST)
    assert "with an op; skipped" in str(error)
    assert request == json.loads(REQUEST)


def test_an_object_that_is_not_json_is_told_and_the_next_one_found() -> None:
    first, second = stream().feed('{"op": nonsense}' + REQUEST)
    assert "not JSON" in str(first)
    assert second == json.loads(REQUEST)


def test_binary_data_that_is_no_text_is_told_once_and_forgotten() -> None:
    reader = stream()
    assert len(reader.feed(b"\xff\xfe\x80")) == 1
    assert reader.feed(b"\xff\xfe\x80") == []
    assert reader.feed(REQUEST.encode()) == [json.loads(REQUEST)]


def test_a_long_request_is_found_as_text() -> None:
    reader = RequestStream(LIMIT, 50)
    long = json.dumps({"op": "publish", "msg": "x" * 60})
    assert reader.feed(long[:40] + "") == []
    assert reader.feed(long[40:] + REQUEST) == [long, json.loads(REQUEST)]
    assert reader.whole(long) is None
    assert reader.whole(REQUEST) == json.loads(REQUEST)
    assert reader.whole(REQUEST * 2) is None


def test_what_never_ends_is_given_up() -> None:
    reader = stream()
    assert reader.feed('{"op": "' + "x" * (LIMIT - 10)) == []
    (error,) = reader.feed("x" * 20)
    assert "does not end within" in str(error)
    assert reader.waits == 0
    assert reader.feed(REQUEST) == [json.loads(REQUEST)]


@pytest.mark.parametrize("piece", ['{"', '{"a":', '{"a":[', '"{', "{", '\\"{', '{"a":"', "[", '{"a":1,'])
def test_looking_at_every_piece_costs_its_length_only(piece: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """However it is cut and nested, nothing is looked at more than a few times."""
    looked = 0
    end = stream_module._end

    def counting(pattern, text, start):
        nonlocal looked
        stop = end(pattern, text, start)
        looked += stop - start + 1
        return stop

    monkeypatch.setattr(stream_module, "_end", counting)
    reader, text = stream(), piece * (20_000 // len(piece))
    for start in range(0, len(text), 7):
        reader.feed(text[start : start + 7])
    assert looked <= 6 * len(text)
