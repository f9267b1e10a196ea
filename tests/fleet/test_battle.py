"""The main job: two players play a battle on the deployed fleet to its end."""

from tests.support.player import Eyes, Player, hunt
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal

STOPPED, PLAYING = 0, 2


def test_two_players_play_a_battle_to_its_end(rehearsal: Rehearsal, players: tuple[Player, Player]) -> None:
    ann, bob = players
    assert {ann.robot, bob.robot} <= {1, 2, 3}, "a robot's ID is its number"
    with Eyes(rehearsal) as eyes:
        for player in players:
            assert player.ready() == "OK"
        for player in players:
            player.wait_for_game(PLAYING)
        lives: list[int] = []

        def over() -> bool:
            robots = eyes.robots()
            ann.drive(*hunt(robots[ann.robot], robots[bob.robot]))
            life = ann.user("Bob").get("life")
            if life is not None and life not in lives:
                lives.append(life)
            return ann.look()["game"] == STOPPED

        until(over, 120, "Ann shoots Bob to the end")
        assert lives == [100, 60, 20, 0]
        result = [(entry["place"], entry["name"], entry["life"]) for entry in until(lambda: bob.look()["result"])]
        assert result == [(1, "Ann", 100), (2, "Bob", 0)]
