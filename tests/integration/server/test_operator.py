"""An operator leads a battle over real HTTP, and drives over a real rosbridge."""

from collections.abc import Iterator
from typing import Any

import pytest
import requests

from tests.integration.rosbridge.ends import NEUTRAL, Client
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster

TOKEN = "the operators' token"


class Desk:
    """A program with the token."""

    def __init__(self, url: str) -> None:
        self._api = f"{url}/operator/api"
        self._http = requests.Session()
        self._http.headers["Authorization"] = f"Bearer {TOKEN}"

    def get(self, path: str) -> dict[str, Any]:
        with self._http.get(f"{self._api}/{path}", timeout=LATEST) as response:
            response.raise_for_status()
            content: dict[str, Any] = response.json()
        return content

    def say(self, path: str, **content: Any) -> None:
        with self._http.post(f"{self._api}/{path}", json=content, timeout=LATEST) as response:
            assert (response.status_code, response.json()) == (200, {}), response.text

    def close(self) -> None:
        self._http.close()


@pytest.fixture
def rosbridge(ros_master: RosMaster) -> Iterator[int]:
    """Its port."""
    port = free_port()
    settings = {"LASERBOT_ROSBRIDGE_PORT": str(port), "LASERBOT_OPERATOR_TOKEN": TOKEN, "LASERBOT_BIND": "127.0.0.1"}
    program = Program.python("server.rosbridge", env={**ros_master.env, **settings})
    program.wait_for("listening")
    yield port
    program.stop()
    assert "Traceback" not in program.output


@pytest.fixture
def desk(launch, rosbridge: int) -> Iterator[tuple[Any, Desk]]:
    server = launch(LASERBOT_COUNTDOWN="1", LASERBOT_OPERATOR_TOKEN=TOKEN, LASERBOT_ROSBRIDGE_PORT=str(rosbridge))
    server.wait_until_serving()
    desk = Desk(server.url)
    yield server, desk
    desk.close()
    assert "Traceback" not in server.program.output


def cookie(page) -> str:
    return page._http.cookies["laserbot_session"]


def test_a_pause_stops_the_wheels_and_the_clock_until_it_is_over(desk, rosbridge):
    server, operator = desk
    robots = [server.robot("a"), server.robot("b")]
    pages = [server.player(name) for name in ("ada", "bob")]
    listener = server.listener()
    for page in pages:
        page.ready()
    listener.wait_for(lambda status: status["game"] == 2)
    with Client(rosbridge) as eyes, Client(rosbridge, cookie(pages[0])) as ada:
        eyes.operate(operator.get("drive")["ticket"])
        eyes.say("subscribe", topic="/Robot0/command", type="laser_bot_battle/Robot_msg")
        ada.advertise(0)

        def drives() -> bool:
            ada.drive(0)
            return not eyes.hears_nothing_for_now()

        until(drives, 10, "ada drives")
        operator.say("battle", action="pause")
        until(lambda: eyes.hear()["msg"] == NEUTRAL, 5, "the wheels are stopped")
        ada.drive(0)
        assert "the battle is paused" in ada.hear_error()
        status = listener.wait_for(lambda status: status["paused"])
        robots[1].hit()
        server.post("updateGameStatus")
        operator.say("message", text="A break")
        later = listener.wait_for(lambda status: status["message"] == "A break")
        assert later["time_left"] == status["time_left"]
        assert [user["life"] for user in later["users"]] == [100, 100]
        operator.say("battle", action="resume")
        until(drives, 10, "ada drives again")
    for page in pages:
        page.close()


def test_a_robot_out_of_service_is_driven_by_the_operator_only(desk, rosbridge):
    server, operator = desk
    server.robot("a")
    page = server.player("ada")
    with Client(rosbridge) as pad, Client(rosbridge, cookie(page)) as ada:
        operator.say("robots/0", in_service=False)
        server.listener().wait_for(lambda status: status["queue"] == ["ada"])
        pad.operate(operator.get("drive")["ticket"])
        pad.say("subscribe", topic="/Robot0/command", type="laser_bot_battle/Robot_msg")
        pad.advertise(0)

        def drives() -> bool:
            pad.drive(0)
            return not pad.hears_nothing_for_now()

        until(drives, 10, "the operator drives")
        ada.drive(0)
        assert "only signed-in players and operators" in ada.hear_error()
        assert operator.get("state")["robots"][0]["in_service"] is False
    page.close()


def test_what_the_operator_has_decided_outlives_the_server(desk):
    server, operator = desk
    server.robot("a")
    operator.say("names", ban="eve")
    operator.say("message", text="A break")
    operator.say("robots/0", in_service=False)
    until(lambda: operator.get("state")["database"]["waiting"] == 0, 5)
    until(lambda: operator.get("log.json")[-1]["kind"] == "ServiceChanged", 5, "it is written")
    # the page's log is filled beside the game
    until(lambda: operator.get("state")["log"][0]["kind"] == "ServiceChanged", 5, "it is shown")
    before = operator.get("state")
    server.program.kill()
    server.launch()
    server.wait_until_serving()
    after = operator.get("state")
    assert after["names"] == before["names"] == {"banned": ["eve"], "words": []}
    assert after["game"]["message"] == "A break"
    assert after["robots"][0]["in_service"] is False
    assert [entry["kind"] for entry in after["log"]][-3:] == [entry["kind"] for entry in before["log"]][-3:]
    assert server.post("signUpUser", data="Eve")["status"] == "ERROR"
