"""More people than robots: the queue, offers, and seats that pass on."""

from typing import Any

import pytest

from server.game.referee import Verdict
from server.game.rules import Rules


def join(match, *names: str) -> None:
    """Sign up, and wait if there is no robot."""
    for name in names:
        verdict, _ = match.referee.sign_up(name, match.session(name), 0, match.now, wait=True)
        assert verdict in (Verdict.OK, Verdict.QUEUED)


def queue(match) -> list[tuple[str, int | None]]:
    return [(waiter.name, waiter.offer) for waiter in match.state.queue]


def take(match, name: str) -> Verdict:
    return match.referee.take_offer(match.session(name), match.now)[0]


def pass_time(match, seconds: float, gone: tuple[str, ...] = ()) -> None:
    """Like match.wait, with the pages of those who wait."""
    end = match.now + seconds
    while match.now < end:
        match.wait(min(0.4, end - match.now), gone_pages=gone)
        for waiter in match.state.queue:
            if waiter.name not in gone:
                match.referee.seen(waiter.session, match.now)


@pytest.fixture
def two(new_match) -> Any:
    """Two robots, ada and bob on them; cy and dee wait."""
    match = new_match(robots=2)
    join(match, "ada", "bob", "cy", "dee")
    return match


def test_who_finds_no_robot_waits_in_the_order_of_coming(two):
    assert two.names == ["ada", "bob"]
    assert queue(two) == [("cy", None), ("dee", None)]
    assert [waiter.place for waiter in two.state.queue] == [1, 2]
    first, second = (waiter.seconds for waiter in two.state.queue)
    assert 0 < first < second


def test_a_free_robot_is_offered_to_the_first_and_to_nobody_else(two):
    two.sign_out("bob")
    assert queue(two) == [("cy", 1), ("dee", None)]
    assert two.state.available_robots == 0
    assert two.referee.sign_up("eve", "e", 0, two.now)[0] is Verdict.NO_ROBOTS
    assert two.referee.sign_up("eve", "e", 0, two.now, wanted=1)[0] is Verdict.ROBOT_UNAVAILABLE
    assert take(two, "dee") is Verdict.NO_OFFER
    assert take(two, "cy") is Verdict.OK
    assert two.player("cy").robot == 1
    assert take(two, "cy") is Verdict.OK, "twice is once"
    assert queue(two) == [("dee", None)]


def test_who_does_not_take_the_robot_in_time_is_behind_the_next_and_the_second_time_out(two):
    two.sign_out("bob")
    pass_time(two, 19.9)
    assert queue(two) == [("cy", 1), ("dee", None)]
    pass_time(two, 0.2)
    assert queue(two) == [("dee", 1), ("cy", None)]
    assert take(two, "cy") is Verdict.NO_OFFER
    take(two, "dee")
    two.sign_out("dee")
    assert queue(two) == [("cy", 1)]
    two.restart()
    pass_time(two, 20.1)
    assert queue(two) == []
    assert take(two, "cy") is Verdict.UNKNOWN_USER


def test_who_waits_alone_and_misses_the_robot_is_offered_it_once_more(new_match):
    match = new_match(robots=1)
    join(match, "ada", "bob")
    match.sign_out("ada")
    pass_time(match, 25)
    assert queue(match) == [("bob", 0)]
    assert take(match, "bob") is Verdict.OK


def test_a_bot_makes_room_for_a_person_at_once(new_match):
    match = new_match(robots=3)
    join(match, "Bot1", "ada", "Bot2", "bob")
    assert queue(match) == [("bob", 2)]
    assert match.names == ["Bot1", "ada"]
    take(match, "bob")
    join(match, "cy", "dee")
    assert queue(match) == [("cy", 0), ("dee", None)], "there is no third one"


def test_a_bot_does_not_wait(new_match):
    match = new_match(robots=1)
    join(match, "ada")
    assert match.referee.sign_up("Bot1", "b", 0, match.now, wait=True)[0] is Verdict.NO_ROBOTS
    join(match, "cy")
    match.sign_out("ada")
    pass_time(match, 20.1)
    assert queue(match) == [("cy", 0)]
    assert match.referee.sign_up("Bot1", "b", 0, match.now)[0] is Verdict.NO_ROBOTS, "a person's turn is not a bot's"


def test_a_bot_whose_robot_nobody_could_have_stays(new_match):
    match = new_match(robots=1)
    join(match, "Bot1")
    match.referee.robots_linked((), match.now)
    join(match, "ada")
    assert match.names == ["Bot1"]
    match.referee.robots_linked((0,), match.now)
    assert match.names == []
    assert queue(match) == [("ada", 0)]


def test_a_bot_leaves_a_countdown_and_a_battle_that_goes_on_without_it(new_match):
    match = new_match(robots=3)
    match.start("ada", "bob", "Bot1")
    join(match, "cy")
    assert queue(match) == [("cy", 2)]
    assert match.state.game == 2
    match.hit("bob", 10)
    assert [(placing.name, placing.left) for placing in match.state.result] == [
        ("ada", False),
        ("bob", False),
        ("Bot1", True),
    ]
    take(match, "cy")
    match.sign_out("cy")
    match.sign_up("Bot1")
    match.ready("ada", "Bot1")
    join(match, "dee")
    assert (match.state.game, match.state.notice) == (
        0,
        "Countdown stopped: Bot1 makes room for a person, fewer than two players are ready.",
    )


def test_a_bot_fights_on_where_the_battle_would_end_with_it(new_match):
    match = new_match(robots=2)
    match.start("ada", "Bot1")
    join(match, "cy")
    assert queue(match) == [("cy", None)]
    match.hit("Bot1", 10)
    assert queue(match) == [("cy", 1)]
    assert [placing.name for placing in match.state.result] == ["ada", "Bot1"]


def test_the_wait_is_told_by_how_long_battles_have_been(two):
    first = two.state.queue[0].seconds
    two.ready("ada", "bob")
    pass_time(two, 15)
    pass_time(two, 10)
    two.hit("bob", 10)
    shorter = two.state.queue[0].seconds
    assert first - shorter == pytest.approx(3 * (150 - 10) / 2, abs=6)
    two.restart()
    assert two.state.queue[0].seconds == pytest.approx(shorter, abs=1)


def test_an_offer_ends_with_its_robot_and_the_place_is_kept(two):
    two.sign_out("bob")
    two.wait(4, dead_robots=(1,))
    assert queue(two) == [("cy", None), ("dee", None)]
    assert two.register("/id_service_client_1") == 1
    assert queue(two) == [("cy", 1), ("dee", None)]


def test_a_robot_that_registers_is_offered_at_once(two):
    assert two.register("/new") == 2
    assert queue(two) == [("cy", 2), ("dee", None)]


def test_who_waits_and_closes_the_page_is_forgotten_after_a_minute(two):
    pass_time(two, 59, gone=("cy",))
    assert queue(two)[0][0] == "cy"
    two.ready("ada", "bob")  # else the idle rule gives a seat away
    pass_time(two, 2, gone=("cy",))
    assert [name for name, _ in queue(two)] == ["dee"]


def test_signing_up_again_keeps_the_place(two):
    verdict, waiter = two.referee.sign_up("cy", "new", 0, two.now, old_session=two.session("cy"), wait=True)
    assert (verdict, waiter.place, waiter.session) == (Verdict.QUEUED, 1, two.session("cy"))
    assert two.referee.sign_up("cy", "new", 0, two.now, wait=True)[0] is Verdict.NAME_TAKEN


def test_one_visitor_waits_once(two):
    two.referee.sign_up("cyril", "new", 0, two.now, old_session=two.session("cy"), wait=True)
    assert queue(two) == [("dee", None), ("cyril", None)]


def test_who_is_not_ready_while_others_wait_is_warned_and_loses_the_seat(two):
    two.ready("ada")
    pass_time(two, 45)
    assert two.player("bob").seat_left == pytest.approx(15)
    assert two.player("ada").seat_left == 0
    pass_time(two, 15.1)
    assert two.names == ["ada"]
    assert queue(two) == [("cy", 1), ("dee", None), ("bob", None)]


def test_one_who_waits_takes_one_seat_and_that_player_waits_as_long_for_the_next(new_match):
    match = new_match(robots=3)
    join(match, "ada", "bob", "eve", "cy")
    pass_time(match, 60.1)
    assert match.names == ["ada", "bob"]
    assert queue(match) == [("cy", 2), ("eve", None)]
    take(match, "cy")
    pass_time(match, 59)
    assert queue(match) == [("eve", None)]
    pass_time(match, 2)
    assert queue(match) == [("eve", 1), ("bob", None)]


def test_nobody_loses_the_seat_to_those_who_have_an_offer(new_match):
    match = new_match(robots=4)
    join(match, "ada", "bob")
    for number in range(5):
        join(match, f"late{number}")
        pass_time(match, 19)  # before the offer of another
    assert "ada" in match.names


def test_nobody_loses_the_seat_while_nobody_waits(new_match):
    match = new_match(robots=1)
    join(match, "ada")
    match.wait(500)
    assert match.player("ada").seat_left == 0
    join(match, "bob")
    pass_time(match, 59)
    assert match.names == ["ada"], "the time begins when somebody waits"
    pass_time(match, 2)
    assert match.names == []


def test_nobody_loses_the_seat_for_watching_a_battle(new_match):
    match = new_match(robots=3)
    join(match, "ada", "bob", "eve", "cy")
    match.ready("ada", "bob")
    pass_time(match, 15)
    pass_time(match, 200)
    assert "eve" in match.names
    match.hit("bob", 10)
    pass_time(match, 59)
    assert "eve" in match.names
    pass_time(match, 2)
    assert "eve" not in match.names


def battle(match) -> None:
    match.ready("ada", "bob")
    pass_time(match, 15)
    match.hit("bob", 10)


def test_after_three_battles_in_a_row_the_seat_passes_on(two):
    for _ in range(2):
        battle(two)
        assert two.names == ["ada", "bob"]
    battle(two)
    assert queue(two) == [("cy", 0), ("dee", 1), ("ada", None), ("bob", None)]
    assert [placing.name for placing in two.state.result] == ["ada", "bob"]


def test_the_seat_stays_while_nobody_waits_and_passes_on_when_somebody_comes(new_match):
    match = new_match(robots=2)
    join(match, "ada", "bob")
    for _ in range(5):
        battle(match)
    assert match.names == ["ada", "bob"]
    join(match, "cy")
    assert queue(match) == [("cy", 0), ("ada", None)], "one has come, so one passes it on"
    assert match.names == ["bob"]


def test_zero_battles_in_a_row_means_as_many_as_one_likes(new_match):
    match = new_match(robots=2, rules=Rules(battles_in_row=0))
    join(match, "ada", "bob", "cy")
    for _ in range(5):
        battle(match)
    assert match.names == ["ada", "bob"]


def test_a_seat_ends_after_its_minutes_once_somebody_waits(new_match):
    match = new_match(robots=2, rules=Rules(seat_minutes=10, idle=86400))
    join(match, "ada")
    match.wait(60)
    join(match, "bob")
    match.wait(700)
    assert match.names == ["ada", "bob"], "while nobody waits, it does not end"
    join(match, "cy")
    match.wait(1)
    assert match.names == ["bob"]
    assert queue(match) == [("cy", 0), ("ada", None)]


def test_whoever_has_had_minutes_waits_for_the_next_ones_minutes_without_any_battle(new_match):
    match = new_match(robots=1, rules=Rules(seat_minutes=10, idle=86400, offer=86400))
    join(match, "ada", "bob")
    for name in ("bob", "ada", "bob"):
        pass_time(match, 601)
        assert take(match, name) is Verdict.OK
        assert match.names == [name]


def test_a_seats_minutes_end_no_battle_and_outlive_the_program(new_match):
    match = new_match(robots=2, rules=Rules(seat_minutes=10, battles_in_row=0, idle=86400))
    join(match, "ada", "bob", "cy")
    pass_time(match, 590)
    match.ready("ada", "bob")
    pass_time(match, 60)
    assert (match.state.game, set(match.names)) == (2, {"ada", "bob"})
    match.restart()
    match.hit("bob", 10)
    assert (match.state.game, match.names) == (0, ["ada"])
    assert queue(match) == [("cy", 1), ("bob", None)]


def wait_from(match, name: str, address: str) -> None:
    match.referee.sign_up(name, match.session(name), 0, match.now, wait=True, address=address)


def test_an_address_that_has_a_robot_gets_another_one_only_when_nobody_from_elsewhere_waits(new_match):
    match = new_match(robots=1)
    wait_from(match, "ada", "10.0.0.1")
    wait_from(match, "adam", "10.0.0.1")
    wait_from(match, "bob", "10.0.0.2")
    match.register("/new")
    assert queue(match) == [("adam", None), ("bob", 1)]
    match.register("/newer")
    assert queue(match) == [("adam", 2), ("bob", 1)]


def test_an_offer_counts_as_a_robot_of_the_address_also_in_the_next_program(new_match):
    match = new_match(robots=0)
    for name, address in (("ada", "10.0.0.1"), ("adam", "10.0.0.1"), ("bob", "10.0.0.2")):
        wait_from(match, name, address)
    match.register("/a")
    match.restart()
    match.register("/b")
    assert queue(match) == [("ada", 0), ("adam", None), ("bob", 1)]


def test_queue_and_offers_outlive_the_program(two):
    two.sign_out("bob")
    pass_time(two, 5)
    two.restart()
    assert queue(two) == [("cy", 1), ("dee", None)]
    assert two.state.queue[0].seconds == pytest.approx(15)
    assert two.state.available_robots == 0
    assert take(two, "cy") is Verdict.OK


def test_one_of_several_robots_at_an_address_passes_on_to_people_from_elsewhere(new_match):
    """However often its players say that they are ready."""
    match = new_match(robots=3)
    for name in ("ada", "adam", "addy"):
        match.referee.sign_up(name, match.session(name), 0, match.now, address="10.0.0.1")
    wait_from(match, "bob", "10.0.0.2")
    for _ in range(20):
        match.ready("ada", "adam", "addy")
        pass_time(match, 4)
        if match.state.queue[0].offer is not None:
            break
        match.ready("ada", "adam", "addy", ready=False)
    assert queue(match)[0] == ("bob", 2)
    assert match.names == ["ada", "adam"], "one waits, so one passes on"


def test_short_wishes_to_play_keep_no_seat(two):
    for _ in range(13):
        pass_time(two, 5)
        if "ada" in two.names:
            two.ready("ada")
            two.ready("ada", ready=False)
    assert "ada" not in two.names


def test_the_queue_is_bounded_in_all_and_for_an_address(new_match):
    match = new_match(robots=0)
    verdicts = [
        match.referee.sign_up(f"n{number}", f"s{number}", 0, match.now, wait=True, address=f"10.0.0.{number // 11}")[0]
        for number in range(122)
    ]
    assert verdicts[:11] == [Verdict.QUEUED] * 10 + [Verdict.NO_ROBOTS]
    assert verdicts.count(Verdict.QUEUED) == 100


def test_an_offer_is_withdrawn_when_its_robot_leaves_its_topics(two):
    two.sign_out("bob")
    assert queue(two)[0] == ("cy", 1)
    two.referee.robots_linked({0}, two.now)
    assert queue(two)[0] == ("cy", None)
    assert take(two, "cy") is Verdict.NO_OFFER
    two.referee.robots_linked({0, 1}, two.now)
    assert queue(two)[0] == ("cy", 1)


def test_a_name_in_other_letters_is_the_same_player(two):
    assert two.referee.set_ready("ADA", True, two.session("ada"), two.now) is Verdict.OK
    assert two.player("ada").ready
    assert two.referee.sign_out("ADA", two.session("ada"), two.now) is Verdict.OK
    assert "ada" not in two.names
    assert two.referee.set_ready("cy", True, two.session("cy"), two.now) is Verdict.UNKNOWN_USER, "who waits"


def test_time_of_being_ready_is_not_idle(new_match):
    """cy waits from the beginning; ada is idle for 20 s, then ready for 50 s."""
    match = new_match(robots=1)
    join(match, "ada", "cy")
    pass_time(match, 20)
    match.ready("ada")
    pass_time(match, 50)
    match.ready("ada", ready=False)
    pass_time(match, 39)
    assert match.names == ["ada"]
    pass_time(match, 2)
    assert match.names == []


def test_a_deadline_that_comes_up_late_is_of_now(new_match):
    """Somebody from elsewhere has waited for long when two of one address have ended their battle."""
    match = new_match(robots=2)
    for name in ("ada", "adam"):
        match.referee.sign_up(name, match.session(name), 0, match.now, address="10.0.0.1")
    match.ready("ada", "adam")
    pass_time(match, 15)
    wait_from(match, "bob", "10.0.0.2")
    pass_time(match, 100)
    match.hit("adam", 10)
    match.wait(0.4)
    assert ("bob", 1) in queue(match)
    times = [one.at for one in match.referee.take_journal()]
    assert times == sorted(times)


def test_a_pause_of_the_program_is_no_time_of_waiting(new_match):
    match = new_match(robots=2)
    join(match, "ada", "bob")
    match.ready("ada")
    pass_time(match, 30)
    join(match, "cy")
    pass_time(match, 30)
    match.now += 20
    match.referee.extend_deadlines(20, match.now)
    pass_time(match, 29)
    assert match.names == ["ada", "bob"]
    pass_time(match, 2)
    assert match.names == ["ada"]
