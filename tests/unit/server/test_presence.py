"""Who is there: signing up and out, silent robots, closed pages."""

import pytest

from laser_bot_battle.names import key_digest
from server.game.referee import Verdict


def sign_up(match, name, session="s", old_session=None):
    verdict, player = match.referee.sign_up(name, session, 0, match.now, old_session=old_session)
    return verdict, player and player.robot


def test_sign_up_claims_the_lowest_free_robot(match):
    assert sign_up(match, "ada", "1") == (Verdict.OK, 0)
    assert sign_up(match, "bob", "2") == (Verdict.OK, 1)
    assert match.referee.sign_out("ada", "1", match.now) is Verdict.OK
    assert sign_up(match, "cy", "3") == (Verdict.OK, 0)
    assert match.state.available_robots == 2


@pytest.mark.parametrize("same", ["jörg", "Jörg", "JÖRG", "ＪÖrg"])
def test_a_name_is_taken_only_once_however_it_is_written(match, same):
    sign_up(match, "Jörg", "1")
    assert sign_up(match, same, "2") == (Verdict.NAME_TAKEN, None)
    assert sign_up(match, "Jorg", "3") == (Verdict.OK, 1)
    assert match.player("Jörg").session == "1"


def test_without_a_free_robot_nobody_signs_up(new_match):
    match = new_match(robots=1)
    sign_up(match, "ada")
    before = match.state
    assert sign_up(match, "bob") == (Verdict.NO_ROBOTS, None)
    assert sign_up(match, "ada", "other") == (Verdict.NAME_TAKEN, None)
    assert match.state == before


def test_a_page_that_signs_up_under_another_name_leaves_no_driverless_player_behind(match):
    sign_up(match, "ada", "1")
    assert sign_up(match, "eve", "2", old_session="1") == (Verdict.OK, 1)
    assert match.names == ["eve"]
    assert match.state.available_robots == 3


def test_signing_up_again_with_the_same_session_keeps_the_robot(match):
    sign_up(match, "ada", "1")
    assert sign_up(match, "ada", "2", old_session="1") == (Verdict.OK, 0)
    assert match.player("ada").session == "1"
    assert match.state.available_robots == 3


def test_a_new_user_has_full_life_and_is_not_ready(match):
    sign_up(match, "ada")
    player = match.player("ada")
    assert (player.life, player.ready) == (100, False)


def test_nobody_signs_another_out(match):
    match.sign_up("ada")
    assert match.referee.sign_out("ada", "stranger", match.now) is Verdict.NOT_YOURS
    assert match.referee.sign_out("bob", match.session("bob"), match.now) is Verdict.UNKNOWN_USER
    assert match.names == ["ada"]


KEY = "a robot's secret"


def test_only_who_shows_its_key_keeps_a_robot_alive(new_match):
    match = new_match(robots=0)
    match.referee.add_robot("/a", match.now, key=key_digest(KEY), address="10.0.0.7")
    ping = match.referee.robot_alive
    for key in ("", "guess", key_digest(KEY), KEY + " "):
        assert ping(0, match.now + 1, key=key, address="10.0.0.7") is Verdict.NOT_YOURS
    assert ping(0, match.now + 2, key=KEY, address="10.9.9.9") is Verdict.OK, "from wherever: there may be a proxy"
    assert match.referee.next_deadline() == pytest.approx(match.now + 5)


def test_a_robot_without_a_key_is_known_by_its_address(new_match):
    match = new_match(robots=0)
    match.referee.add_robot("/a", match.now, address="10.0.0.7")
    ping = match.referee.robot_alive
    assert ping(0, match.now + 1, address="10.0.0.8") is Verdict.NOT_YOURS
    assert ping(0, match.now + 1, address="") is Verdict.NOT_YOURS
    assert ping(0, match.now + 1, key="any", address="10.0.0.7") is Verdict.OK


def test_a_stopped_robot_cannot_be_kept_alive_by_others(new_match):
    match = new_match(robots=0)
    match.referee.add_robot("/a", match.now, key=key_digest(KEY))
    for _ in range(10):
        match.now += 0.4
        match.referee.robot_alive(0, match.now, key="guess")
    assert match.state.robots == ()


def test_a_robot_that_registers_again_has_its_new_key_only(match):
    match.sign_up("ada")
    match.referee.add_robot("/id_service_client_0", match.now, key=key_digest("new"))
    assert match.referee.robot_alive(0, match.now) is Verdict.NOT_YOURS
    assert match.referee.robot_alive(0, match.now, key="new") is Verdict.OK
    assert match.player("ada").robot == 0


def test_keys_and_addresses_outlive_the_program(new_match):
    match = new_match(robots=0)
    match.referee.add_robot("/a", match.now, key=key_digest(KEY))
    match.referee.add_robot("/b", match.now, address="10.0.0.7")
    match.restart()
    ping = match.referee.robot_alive
    assert [ping(0, match.now, key=key) for key in (KEY, "guess")] == [Verdict.OK, Verdict.NOT_YOURS]
    assert [ping(1, match.now, address=address) for address in ("10.0.0.7", "10.0.0.8")] == [
        Verdict.OK,
        Verdict.NOT_YOURS,
    ]


def test_a_robot_is_offered_only_while_it_is_on_its_topics(new_match):
    match = new_match(robots=0)
    match.referee.add_robot("/fake", match.now)
    assert match.state.available_robots == 0
    assert sign_up(match, "ada") == (Verdict.NO_ROBOTS, None)
    verdict, waiter = match.referee.sign_up("ada", "s", 0, match.now, wait=True)
    assert (verdict, waiter.offer) == (Verdict.QUEUED, None)
    match.referee.robots_linked({0, 99}, match.now)
    assert match.state.queue[0].offer == 0
    match.referee.sign_out("ada", "s", match.now)
    assert match.state.free_robots == (0,)
    match.referee.robots_linked(set(), match.now)
    assert match.state.free_robots == ()


def test_a_player_keeps_a_robot_that_is_off_its_topics_for_a_moment(match):
    match.start("ada", "bob")
    match.referee.robots_linked({1, 2, 3}, match.now)
    assert match.state.game == 2
    assert match.hit("ada") == [True]
    match.referee.robots_linked({0, 1, 2, 3}, match.now)
    assert match.player("ada").robot == 0


def test_what_is_on_its_topics_is_so_in_the_next_program(match):
    match.referee.robots_linked({1, 2}, match.now)
    match.restart()
    assert match.state.free_robots == (1, 2)


def test_a_silent_robot_is_removed_after_2_to_4_seconds_and_its_player_10_seconds_later(match):
    match.sign_up("ada", "bob")
    match.wait(2, dead_robots=(0,))
    assert match.state.robots == (0, 1, 2, 3)
    match.wait(2, dead_robots=(0,))
    assert match.state.robots == (1, 2, 3)
    assert match.referee.robot_alive(0, match.now) is Verdict.UNKNOWN_ROBOT
    assert match.names == ["ada", "bob"]
    match.wait(8.9)
    assert match.names == ["ada", "bob"]
    match.wait(0.5)
    assert match.names == ["bob"]


def test_a_robot_that_is_back_in_time_still_has_its_player(match):
    match.sign_up("ada")
    match.wait(10, dead_robots=(0,))
    assert match.register("/id_service_client_0") == 0
    match.wait(20)
    assert match.player("ada").robot == 0
    assert match.state.available_robots == 3


def test_nobody_goes_into_a_battle_without_a_robot(match):
    match.sign_up("ada")
    match.wait(4, dead_robots=(0,))
    assert match.referee.set_ready("ada", True, match.session("ada"), match.now) is Verdict.ROBOT_AWAY
    match.register("/id_service_client_0")
    match.ready("ada")


def test_a_robot_lost_in_a_battle_comes_back_for_the_next_one(match):
    match.start("ada", "bob", "cy")
    match.wait(4, dead_robots=(0,))
    assert match.register("/id_service_client_0") == 0
    assert not match.player("ada").ready
    assert match.hit("ada") == [False]
    match.hit("bob", times=10)
    assert match.ranking == [(1, "cy"), (2, "bob"), (3, "ada")]
    match.ready("ada", "cy")
    match.wait(15)
    assert match.state.game == 2


def test_three_robots_that_die_together_are_removed_together(match):
    match.wait(2.9, dead_robots=(0, 1, 2))
    assert match.state.robots == (0, 1, 2, 3)
    match.wait(0.2, dead_robots=(0, 1, 2))
    assert match.state.robots == (3,)


def test_a_robot_that_pings_stays(match):
    match.wait(60)
    assert match.state.robots == (0, 1, 2, 3)


def test_a_robot_lost_in_a_battle_makes_its_player_a_quitter(match):
    match.start("ada", "bob", "cy")
    match.wait(4, dead_robots=(0,))
    assert match.state.game == 2
    match.hit("bob", times=10)
    assert match.ranking == [(1, "cy"), (2, "bob"), (3, "ada")]
    assert match.placing("ada").left


def test_the_opponents_robot_lost_ends_the_battle_with_a_reason(match):
    match.start("ada", "bob")
    match.wait(4, dead_robots=(1,))
    assert match.state.game == 0
    assert match.ranking == [(1, "ada"), (2, "bob")]
    assert "bob lost the robot" in match.state.notice


def test_no_double_damage_after_a_robot_came_back(match):
    match.start("ada", "bob", "cy")
    match.hit("ada", times=10)
    match.wait(14, dead_robots=(0,))
    assert match.register("/id_service_client_0") == 0
    match.sign_up("dee")
    assert match.player("dee").robot == 0
    match.hit("bob", times=10)
    match.ready("dee", "cy")
    match.wait(15)
    match.hit("dee")
    assert match.player("dee").life == 90
    assert match.player("cy").life == 100


def test_a_robot_that_registers_again_while_listed_keeps_its_player(match):
    match.start("ada", "bob")
    match.wait(2, dead_robots=(0,))
    assert match.register("/id_service_client_0") == 0
    match.wait(2.5, dead_robots=(0,))
    assert match.player("ada").robot == 0
    assert match.state.game == 2


def test_a_player_whose_page_is_gone_for_a_minute_is_signed_out(match):
    match.sign_up("ada", "bob")
    match.wait(59.9, gone_pages=("ada",))
    assert match.names == ["ada", "bob"]
    match.wait(0.2, gone_pages=("ada",))
    assert match.names == ["bob"]
    assert match.state.available_robots == 3


def test_a_closed_page_cannot_hold_up_a_battle(match):
    match.start("ada", "bob")
    match.wait(16, gone_pages=("bob",))
    assert match.state.game == 0
    assert match.ranking == [(1, "ada"), (2, "bob")]
    assert match.placing("bob").left
    assert "bob left the page" in match.state.notice


def test_a_sign_of_life_names_the_player_of_the_session(match):
    match.sign_up("ada")
    assert match.referee.seen(match.session("ada"), match.now).name == "ada"
    assert match.referee.seen("stranger", match.now) is None


def test_the_next_deadline_is_the_earliest_of_all(new_match):
    match = new_match(robots=0)
    assert match.referee.next_deadline() is None
    match.referee.add_robot("/a", 1000.0)
    match.referee.add_robot("/b", 1001.0)
    assert match.referee.next_deadline() == pytest.approx(1003.0)
