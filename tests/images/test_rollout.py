"""An update replaces the master's pod in the middle of a battle, where components/kept-data keeps the game."""

from collections.abc import Iterator
from pathlib import Path

import pytest
import requests

from tests.support.manifests import Manifests, customized
from tests.support.play import PLAYING, a_bot_waits, obeys, reconnect, shoot_to_the_end
from tests.support.player import Eyes, Hunter, Player
from tests.support.pods import ClusterBattle, free_node_ports, merged
from tests.support.polling import LATEST, until

pytestmark = pytest.mark.slow
DAMAGE = 10


@pytest.fixture
def versions(version: str, tmp_path: Path) -> Iterator[Manifests]:
    """The same arena before an update and after it, which has another time limit."""
    ports = free_node_ports()

    def described(limit: int) -> Manifests:
        rules = [f"LASERBOT_HIT_DAMAGE={DAMAGE}", "LASERBOT_COUNTDOWN=1", f"LASERBOT_BATTLE_LIMIT={limit}"]
        generators = [ports, merged("settings", *rules)]
        made = customized(tmp_path, "sim", "node-ports", "kept-data", configMapGenerator=generators)
        return made.within("laserbot")

    return map(described, (600, 900))


def test_a_battle_goes_on_when_the_masters_pod_is_replaced(versions: Iterator[Manifests], tmp_path: Path) -> None:
    with ClusterBattle(next(versions), tmp_path) as battle:
        battle.wait_until_ready()
        until(lambda: a_bot_waits(battle), 60, "a battle can begin")
        with Player(battle, "Ann") as ann, Eyes(battle) as eyes:
            hunter, prey = Hunter(eyes.floor), 1 - ann.robot
            assert ann.ready() == "OK"
            ann.wait_for_game(PLAYING, 30)

            def bot_is_hit() -> bool:
                ann.drive(*hunter.command(eyes.robots(), ann.robot, prey))
                return int(ann.user("Bot1")["life"]) < 100

            until(bot_is_hit, 60, "Ann hits the bot")
            ann.drive()
            before, old = ann.look(), battle.pods["master"].address

            battle.roll_out(next(versions), "master")
            assert battle.pods["master"].address != old
            battle.wait_until_ready(120)
            reconnect(ann)
            ann.wait_for_game(PLAYING, 60)
            after, place = ann.look(), eyes.robots()[prey]
            assert after["battle"] == before["battle"]
            assert after["time_left"] < before["time_left"]
            lives = [{user["name"]: user["life"] for user in status["users"]} for status in (before, after)]
            assert lives[1].keys() == {"Ann", "Bot1"}
            assert all(lives[1][name] <= life for name, life in lives[0].items())
            until(lambda: eyes.robots()[prey] != place, 60, "the bot drives its robot again")
            obeys(ann, eyes)

            shoot_to_the_end(ann, prey, eyes)
            result = {entry["name"]: entry["life"] for entry in ann.look()["result"]}
        listed = requests.get(f"{battle.web}/results.json", timeout=LATEST).json()
        (kept,) = listed["battles"]
        assert (kept["number"], kept["running"]) == (before["battle"], False)
        assert {each["name"]: each["life"] for each in kept["fighters"]} == result
        assert min(result.values()) == 0
        # of before and after the update
        assert all(each["life"] == 100 - DAMAGE * each["hits_taken"] for each in kept["fighters"])
