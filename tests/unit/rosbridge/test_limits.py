"""Who may have how many sockets."""

from server.access.identity import GUEST, OPERATOR, Identity
from server.websocket.limits import Limits, SocketLimits, SocketOwner, owner_of

LIMITS = Limits(clients=10, kept=4, guests=3, player=2)
PLAYER = Identity(session="al")


def sockets(*taken: SocketOwner) -> SocketLimits:
    new = SocketLimits(LIMITS)
    for place in taken:
        assert new.refusal(place) == ""
        new.take(place)
    return new


def guest(address: str) -> SocketOwner:
    return owner_of(GUEST, False, address)


AL, OPS = owner_of(PLAYER, True, "1"), owner_of(OPERATOR, False, "1")


def test_guests_of_one_address_leave_room_for_those_of_another() -> None:
    some = sockets(guest("1"), guest("1"), guest("1"))
    assert some.refusal(guest("1")) == "1 has 3 sockets already"
    assert some.refusal(guest("2")) == ""
    some.leave(guest("1"))
    assert some.refusal(guest("1")) == ""


def test_all_guests_together_leave_room_for_players_and_operators() -> None:
    full = sockets(*[guest(str(number // 3)) for number in range(6)])
    assert full.refusal(guest("9")) == "6 guests are connected"
    for place in (AL, AL, OPS, OPS):
        assert full.refusal(place) == ""
        full.take(place)
    assert full.refusal(OPS) == "10 clients are connected"


def test_a_player_has_some_sockets_wherever_they_come_from() -> None:
    one = sockets(AL, owner_of(PLAYER, True, "2"))
    assert one.refusal(AL) == "a player has 2 sockets already"
    assert one.refusal(owner_of(Identity(session="bo"), True, "1")) == ""


def test_a_session_of_nobody_is_a_guests() -> None:
    assert owner_of(PLAYER, False, "1") == guest("1")


def test_a_guest_who_becomes_a_player_leaves_his_place_to_others() -> None:
    some = sockets(guest("1"), guest("1"), guest("1"))
    assert some.change(guest("1"), AL) == AL
    assert some.refusal(guest("1")) == ""
    assert some.change(guest("1"), AL) == AL
    assert some.change(guest("1"), AL) == guest("1")


def test_a_player_who_signs_out_stays_though_there_are_guests_enough() -> None:
    some = sockets(guest("1"), guest("1"), guest("1"), AL)
    assert some.change(AL, guest("1")) == guest("1")
    assert some.refusal(guest("1"))
    some.leave(guest("1"))
    assert some.refusal(guest("1"))
