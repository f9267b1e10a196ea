"""Who a client is: by cookie or auth, which may be quicker than the news of the player."""

import json
import logging
import time

import pytest

from laser_bot_battle.names import session_digest, session_ticket
from server.access.identity import GUEST, OPERATOR, session_identity
from server.rosbridge.capabilities.publishing import MAX_WAITING
from server.rosbridge.effects import Log, OpenPublisher, Publish
from server.rosbridge.gate import Gate
from tests.unit.rosbridge.clients import ADVERTISE, PUBLISH, TOKEN, Server, error, say, without_log

CURVE = b"\x01\xff\x00"  # what PUBLISH says, serialized


def test_a_player_authenticates_by_name_and_token(server: Server) -> None:
    server.battle()
    client = server.client(GUEST)
    assert say(client, op="auth", client="al", mac=TOKEN, dest="", rand="x", t=1, level="", end=9) == []
    assert client.receive(PUBLISH, 0.0)[-1] == Publish("/Robot3/command", CURVE)


def test_a_player_may_authenticate_a_moment_before_the_referee_says_so(server: Server) -> None:
    client = server.client(GUEST)
    assert say(client, op="auth", client="al", mac=TOKEN) == []
    server.battle(now=1.0)
    assert client.updated(1.0) == []
    assert client.identity == session_identity(TOKEN)


@pytest.mark.parametrize("name", ["al", "operator"])
@pytest.mark.parametrize("token", ["guess", "", "\ud800", "ö"], ids=ascii)
def test_a_token_that_nobody_has_is_refused_after_a_while(server: Server, name: str, token: str) -> None:
    who = session_identity("of before")
    client = server.client(who)
    assert say(client, op="auth", client=name, mac=token, id=4) == []
    assert client.updated(1.9) == []
    refusal = error(client.updated(2.0))
    assert (refusal["msg"], refusal["id"]) == ("no player has this name and this token", 4)
    assert client.updated(9.0) == []
    assert client.identity == who


def test_a_player_authenticates_by_the_ticket_of_its_page(server: Server) -> None:
    ticket = session_ticket(session_digest(TOKEN), time.time())
    early, late = server.client(GUEST), server.client(GUEST)
    assert say(early, op="auth", client="al", mac=ticket) == []
    server.battle(now=1.0)
    assert early.updated(1.0) == []
    assert say(late, op="auth", client="al", mac=ticket) == []
    assert early.identity == late.identity == session_identity(TOKEN)


def test_a_token_does_not_fit_another_name(server: Server) -> None:
    server.battle()
    client = server.client(GUEST)
    assert say(client, op="auth", client="bo", mac=TOKEN) == []
    assert "no player has this name" in error(client.updated(2.0))["msg"]
    assert client.identity == GUEST


def test_a_secret_without_end_is_refused_at_once(server: Server) -> None:
    client = server.client(GUEST)
    assert "more than 1000 characters" in error(say(client, op="auth", client="al", mac="x" * 1001))["msg"]
    assert client.updated(2.0) == []


def test_the_operator_authenticates(server: Server) -> None:
    client = server.client(GUEST)
    assert say(client, op="auth", client="operator", mac="secret") == []
    assert client.identity == OPERATOR


def test_the_operators_second_try_counts(server: Server) -> None:
    client = server.client(GUEST)
    say(client, op="auth", client="operator", mac="sceret")
    say(client, op="auth", client="operator", mac="secret")
    assert client.updated(2.0) == []
    assert client.identity == OPERATOR


def test_wrong_operator_tokens_are_logged_with_the_address_until_there_are_too_many(server: Server) -> None:
    client, operator = server.client(GUEST), server.client(GUEST)
    client.address = operator.address = "10.0.0.7"
    guess = json.dumps({"op": "auth", "client": "operator", "mac": "guess"})
    for _ in range(5):
        assert client.receive(guess, 0.0)[0] == Log(logging.WARNING, "wrong operator token from 10.0.0.7")
    assert client.receive(guess, 0.0) == []
    assert say(operator, op="auth", client="operator", mac="secret") == []
    assert operator.identity == OPERATOR, "the right one is let in"
    assert "too many wrong operator tokens" in error(client.updated(2.0))["msg"]
    assert client.updated(9.0) == []
    assert client.identity == GUEST


def test_a_player_called_operator_is_let_in_after_guesses_from_the_same_address(server: Server) -> None:
    client = server.client(GUEST)
    for _ in range(9):
        say(client, op="auth", client="operator", mac="guess")
    assert say(client, op="auth", client="operator", mac=TOKEN) == []
    server.battle(now=1.0, name="operator")
    assert client.updated(1.0) == []
    assert client.identity == session_identity(TOKEN)


def test_a_player_may_be_called_operator_and_is_none(server: Server) -> None:
    early, late = server.client(GUEST), server.client(GUEST)
    assert say(early, op="auth", client="operator", mac=TOKEN) == []
    server.battle(now=1.0, name="operator")
    assert early.updated(1.0) == []
    assert say(late, op="auth", client="operator", mac=TOKEN) == []
    assert early.identity == late.identity == session_identity(TOKEN)


def test_without_a_token_set_nobody_is_operator(server: Server) -> None:
    server.gate = Gate("")
    client = server.client(GUEST)
    say(client, op="auth", client="operator", mac="")
    error(client.updated(2.0))
    assert client.identity == GUEST


def test_a_player_may_advertise_a_moment_before_the_referee_says_so(server: Server) -> None:
    al = server.client(session_identity(TOKEN))
    assert al.receive(ADVERTISE, 0.0) == []
    assert al.updated(1.0) == []
    server.battle(now=1.0, game=0)
    (opened,) = al.updated(1.0)
    assert isinstance(opened, OpenPublisher)
    assert opened.topic == "/Robot3/command"
    assert al.updated(9.0) == []


def test_a_player_may_authenticate_and_advertise_in_one_breath(server: Server) -> None:
    al = server.client(GUEST)
    say(al, op="auth", client="al", mac=TOKEN)
    assert al.receive(ADVERTISE, 0.0) == []
    server.battle(now=1.0)
    (opened,) = al.updated(1.0)
    assert isinstance(opened, OpenPublisher)


def test_a_newcomer_may_not_advertise_more_than_any_player(server: Server) -> None:
    al = server.client(session_identity(TOKEN))
    say(al, op="advertise", topic="/Robot4/command", type="laser_bot_battle/Robot_msg", id=5)
    server.battle(now=1.0)
    refusal = error(al.updated(1.0))
    assert (refusal["msg"], refusal["id"]) == ("al may advertise /Robot3/command only, not /Robot4/command", 5)


def test_a_newcomer_may_change_its_mind(server: Server) -> None:
    al = server.client(session_identity(TOKEN))
    al.receive(ADVERTISE, 0.0)
    say(al, op="set_level", level="warning")
    assert say(al, op="unadvertise", topic="/Robot3/command") == []
    server.battle(now=1.0)
    assert al.updated(1.0) == []


def test_a_newcomer_cannot_ask_without_end(server: Server) -> None:
    stranger = server.client(session_identity("of nobody"))
    for number in range(MAX_WAITING):
        assert say(stranger, op="advertise", topic=f"/p{number}", type="std_msgs/String") == []
    error(say(stranger, op="advertise", topic="/more", type="std_msgs/String"))
    assert len(without_log(stranger.updated(2.0))) == MAX_WAITING


def test_a_player_whose_advertising_was_refused_drives_nevertheless(server: Server) -> None:
    """While the referee was away, say."""
    al = server.client(session_identity(TOKEN))
    assert al.receive(ADVERTISE, 0.0) == []
    assert al.updated(1.9) == []
    assert "only signed-in players" in error(al.updated(2.0))["msg"]
    server.battle()
    opened, published = al.receive(PUBLISH, 3.0)
    assert isinstance(opened, OpenPublisher)
    assert published == Publish("/Robot3/command", CURVE)
    assert al.receive(PUBLISH, 3.0) == [published]
