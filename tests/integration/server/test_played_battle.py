"""A battle over real HTTP and real ROS: what pages and subscribers of /game_status get to know."""

import hashlib
import json
import threading
from typing import Any

import pytest
import requests

from tests.support.polling import LATEST, until


@pytest.fixture
def battle(server):
    """Two players with a robot each, both ready, the battle running; and a subscriber."""
    robots = {"ada": server.robot("a"), "bob": server.robot("b")}
    pages = {name: server.player(name) for name in robots}
    listener = server.listener()
    for page in pages.values():
        page.ready()
    listener.wait_for(lambda status: status["game"] == 2)
    yield robots, pages, listener
    for page in pages.values():
        page.close()


def users(page) -> list[dict]:
    return json.loads(page.post("updateGameStatus")["users"])


def test_hits_lower_life_to_the_end_and_everyone_gets_the_result(battle):
    robots, pages, listener = battle
    for life in (60, 20, 0):
        robots["bob"].hit()
        if life:
            listener.wait_for_life("bob", life)
    status = listener.wait_for(lambda status: status["game"] == 0)
    assert [(user["place"], user["name"], user["life"], user["left"]) for user in status["result"]] == [
        (1, "ada", 100, False),
        (2, "bob", 0, False),
    ]
    assert status["notice"] == "Battle over: bob was shot down."
    assert status["battle"] == 1
    assert [user["name"] for user in users(pages["bob"])] == ["ada", "bob"]
    assert not any(user["ready"] for user in status["users"])


def test_countdown_and_battle_are_seen_by_subscribers_and_pages_alike(battle, server):
    _, pages, listener = battle
    games = [status["game"] for status in listener.heard]
    assert sorted(set(games)) == [0, 1, 2]
    assert games == sorted(games)
    assert all(0 < status["time_left"] <= 1 for status in listener.heard if status["game"] == 1)
    assert 290 < listener.latest["time_left"] <= 300
    assert pages["ada"].post("updateGameStatus")["game"] == 2
    assert pages["ada"].post("playerReady", user="ada", ready=0) == {"status": "STARTED"}

    for user in listener.latest["users"]:
        token = pages[user["name"]]._http.cookies["laserbot_session"]
        assert user["session"] == hashlib.sha256(token.encode()).hexdigest()

    late = server.listener()
    assert [user["name"] for user in late.heard[0]["users"]] == ["ada", "bob"], "at once"
    count = len(late.heard)
    until(lambda: len(late.heard) >= count + 3, 3, "a heartbeat")


def test_a_robot_that_vanishes_takes_its_player_along_and_the_battle_ends_by_the_rules(battle, server):
    robots, _, listener = battle
    robots["ada"].vanish()
    status = listener.wait_for(lambda status: status["game"] == 0)
    assert [(user["place"], user["name"], user["left"]) for user in status["result"]] == [
        (1, "bob", False),
        (2, "ada", True),
    ]
    assert "ada lost the robot" in status["notice"]
    assert {user["name"] for user in status["users"]} == {"ada", "bob"}, "it may come back"
    listener.wait_for(lambda status: [user["name"] for user in status["users"]] == ["bob"], 20)


@pytest.mark.slow
def test_a_late_hit_for_a_removed_robot_hurts_nobody_and_a_returned_robot_is_hit_once(server):
    robots = {name: server.robot(name) for name in ("a", "b", "c")}
    pages = [server.player(name) for name in ("ada", "bob", "cy")]
    listener = server.listener()
    for page in pages:
        page.ready()
    listener.wait_for(lambda status: status["game"] == 2)
    robots["a"].vanish()

    def is_gone(status: dict[str, Any]) -> bool:
        for page in pages[1:]:  # they stay open
            page.post("updateGameStatus")
        return len(status["users"]) == 2

    listener.wait_for(is_gone, 20)
    late = server.peer("hit", "0")
    late.wait_for("published")
    assert server.robot("a").id == 0
    pages.append(server.player("dee"))
    robots["b"].hit()  # comes after the late one
    listener.wait_for_life("bob", 60)
    assert {user["name"]: user["life"] for user in users(pages[-1])} == {"cy": 100, "bob": 60, "dee": 100}
    assert "Traceback" not in server.program.output
    for page in pages:
        page.close()


@pytest.mark.slow
def test_two_logins_with_one_name_at_the_same_instant(server):
    for name in ("a", "b", "c"):
        server.robot(name)
    barrier = threading.Barrier(6)
    answers = []

    def login() -> None:
        barrier.wait()
        answers.append(server.post("signUpUser", data="ada")["status"])

    threads = [threading.Thread(target=login) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(answers) == ["OK"] + ["UNAVAILABLE"] * 5
    assert server.post("getAvailableRobots")["availableR"] == 2


def test_bad_input_over_real_http_is_answered_in_json(server):
    def chunks():
        for _ in range(30):
            yield b"data=" + b"x" * 1000

    def post(**request):
        with requests.post(f"{server.url}/signUpUser", timeout=LATEST, **request) as response:
            return response.status_code, response.json()["status"]

    form = {"Content-Type": "application/x-www-form-urlencoded"}
    assert post(data={"data": "x" * 100_000}) == (413, "ERROR")
    assert post(data=chunks(), headers=form) == (413, "ERROR")
    assert post(data=b"\x00\xff%", headers=form) == (400, "ERROR")
    assert post(json={"data": "ada"}) == (400, "ERROR")
    assert post(data={"data": "a  b"}) == (400, "ERROR")
    assert "Traceback" not in server.program.output


@pytest.mark.slow
def test_a_ros_master_that_hangs_does_not_hold_up_the_news(launch, own_master):
    own_master.start()
    server = launch(master=own_master)
    server.wait_until_serving()
    gone, kept = server.robot("gone"), server.robot("kept")
    listener = server.listener()
    listener.wait_for(lambda status: status["available_robots"] == 2)
    own_master.pause()
    try:
        gone.vanish()  # the server takes its leave of its topic, by the master
        listener.wait_for(lambda status: status["available_robots"] == 1)
        heard = len(listener.heard)
        until(lambda: len(listener.heard) > heard + 4, 10, "the news goes on")
        ada = server.player("ada")
        assert listener.wait_for(lambda status: status["users"])["users"][0]["robot"] == kept.id
        ada.close()
    finally:
        own_master.resume()
