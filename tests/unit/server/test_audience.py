"""What people who only watch may do: a vote for each device, and cheers that cannot become too many."""

from http import HTTPStatus

import pytest
from flask import Flask
from flask.testing import FlaskClient
from hypothesis import given
from hypothesis import strategies as st

from server.pages.audience import (
    CHEERED,
    COOKIE,
    MAX_CHEERS,
    MAX_DEVICES,
    PER_ADDRESS,
    SHOWN_AFTER,
    Audience,
    Ballot,
    create_audience,
)
from server.web.visitors import VISITOR

CHOICES = (("children", False), ("beginners", False), ("ours", True))
OK, GONE, MANY = HTTPStatus.OK, HTTPStatus.GONE, HTTPStatus.TOO_MANY_REQUESTS


@pytest.fixture
def audience() -> Audience:
    """With a vote that is open until 30 s."""
    audience = Audience()
    audience.open(Ballot(7, CHOICES, 30.0))
    return audience


def votes(audience: Audience, now: float = 1.0) -> list[int] | None:
    vote = audience.told(now)["vote"]
    return vote and [choice["votes"] for choice in vote["choices"]]


@given(st.lists(st.tuples(st.integers(0, 20), st.integers(0, 2)), max_size=60))
def test_each_device_has_one_vote_its_last(cast: list[tuple[int, int]]) -> None:
    audience = Audience()
    audience.open(Ballot(7, CHOICES, 30.0))
    for device, choice in cast:
        assert audience.vote(f"device {device}", "10.0.0.1", 7, choice, 1.0) is OK
    last = list(dict(cast).values())
    assert votes(audience) == [last.count(choice) for choice in range(3)]


def test_what_cannot_be_chosen_is_refused_and_another_vote_too(audience: Audience) -> None:
    for choice in (-1, 3):
        assert audience.vote("a", "", 7, choice, 1.0) is HTTPStatus.BAD_REQUEST
    assert audience.vote("a", "", 6, 0, 1.0) is GONE
    assert Audience().vote("a", "", 7, 0, 1.0) is GONE
    assert votes(audience) == [0, 0, 0]


def test_it_ends_and_is_told_for_some_time_after(audience: Audience) -> None:
    assert audience.vote("a", "", 7, 1, 29.9) is OK
    assert audience.vote("b", "", 7, 1, 30.0) is GONE
    assert audience.told(30.0)["vote"]["seconds_left"] == 0
    assert votes(audience, 30.0 + SHOWN_AFTER - 0.1) == [0, 1, 0]
    assert votes(audience, 30.0 + SHOWN_AFTER) is None


def test_the_operator_may_end_it_early_and_the_votes_stay(audience: Audience) -> None:
    audience.vote("a", "", 7, 2, 1.0)
    audience.open(Ballot(7, CHOICES, 2.0))
    assert audience.vote("b", "", 7, 2, 2.0) is GONE
    assert votes(audience, 2.0) == [0, 0, 1]


def test_a_new_vote_begins_with_none(audience: Audience) -> None:
    audience.vote("a", "", 7, 2, 1.0)
    audience.open(Ballot(8, CHOICES, 60.0))
    assert votes(audience) == [0, 0, 0]
    assert audience.vote("a", "", 7, 2, 1.0) is GONE


def test_an_address_has_no_more_votes_than_a_hall_needs(audience: Audience) -> None:
    answers = [audience.vote(f"device {number}", "10.0.0.1", 7, 0, 1.0) for number in range(PER_ADDRESS + 1)]
    assert answers == [OK] * PER_ADDRESS + [MANY]
    assert audience.vote("device 0", "10.0.0.1", 7, 1, 1.0) is OK, "who has voted may change it"
    assert audience.vote("another", "10.0.0.2", 7, 0, 1.0) is OK


def test_all_together_are_bounded(audience: Audience) -> None:
    answers = [audience.vote(f"device {number}", f"10.0.0.{number}", 7, 0, 1.0) for number in range(MAX_DEVICES + 1)]
    assert answers.count(OK) == MAX_DEVICES
    assert answers[-1] is MANY


def test_cheers_are_told_for_some_seconds(audience: Audience) -> None:
    for number in range(3):
        assert audience.cheer(f"device {number}", f"10.0.0.{number}", "Zoë", 1.0) is OK
    assert audience.told(1.0 + CHEERED)["cheers"] == {"Zoë": 3}
    assert audience.told(1.1 + CHEERED)["cheers"] == {}


def test_who_cheers_without_end_waits(audience: Audience) -> None:
    answers = [audience.cheer("a", "10.0.0.1", "ada", 1.0) for _ in range(10)]
    assert answers == [OK] * 5 + [MANY] * 5
    assert audience.cheer("a", "10.0.0.1", "ada", 2.0) is OK


def test_cheers_of_an_address_and_of_all_are_bounded(audience: Audience) -> None:
    of_one = [audience.cheer(f"device {number}", "10.0.0.1", "ada", 1.0) for number in range(200)]
    assert of_one.count(OK) == 100
    for number in range(2 * MAX_CHEERS):
        audience.cheer(f"other {number}", f"10.1.0.{number}", f"name {number}", 1.0)
    told = audience.told(1.0)["cheers"]
    assert sum(told.values()) <= 64


@pytest.mark.parametrize("name", ["", "x" * 17])
def test_a_name_that_is_none_is_not_cheered_for(audience: Audience, name: str) -> None:
    assert audience.cheer("a", "", name, 1.0) is HTTPStatus.BAD_REQUEST


# over HTTP


@pytest.fixture
def phone(audience: Audience) -> FlaskClient:
    app = Flask(__name__)
    app.register_blueprint(create_audience(audience, clock=lambda: 1.0))
    return app.test_client()


def test_a_phone_gets_its_cookie_once_and_votes_and_cheers(phone: FlaskClient) -> None:
    assert phone.post("/audience/vote?number=7&choice=0").status_code == 403
    first = phone.get("/audience")
    assert first.json == {
        "vote": {
            "number": 7,
            "choices": [{"name": name, "own": own, "votes": 0} for name, own in CHOICES],
            "seconds_left": 29.0,
        },
        "cheers": {},
    }
    assert "HttpOnly" in first.headers["Set-Cookie"]
    assert "Set-Cookie" not in phone.get("/audience").headers
    assert phone.post("/audience/vote?number=7&choice=2").status_code == 200
    assert phone.post("/audience/cheer?name=ada").status_code == 200
    assert phone.post("/audience/vote?number=x&choice=2").status_code == 410


def test_the_address_counts_that_the_game_server_tells(phone: FlaskClient, audience: Audience) -> None:
    for number in range(PER_ADDRESS):
        audience.vote(f"device {number}", "10.0.0.9", 7, 0, 1.0)
    phone.set_cookie(COOKIE, "0" * 32, path="/audience")
    vote = "/audience/vote?number=7&choice=2"
    assert phone.post(vote, headers={VISITOR: "10.0.0.9"}).status_code == 429
    assert phone.post(vote, headers={VISITOR: "10.0.0.8"}).status_code == 200


def test_a_cookie_that_is_none_of_ours_is_no_device(phone: FlaskClient) -> None:
    phone.set_cookie(COOKIE, "x", path="/audience")
    assert phone.post("/audience/vote?number=7&choice=0").status_code == 403
