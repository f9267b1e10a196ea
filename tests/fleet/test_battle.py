"""The main job: two players play a battle on the deployed fleet to its end."""

from tests.support.play import shoot_to_the_end, start
from tests.support.player import Eyes
from tests.support.polling import until
from tests.support.rehearsal import Rehearsal
from tests.support.roslib_player import RoslibPlayer


def test_two_players_with_roslib_play_a_battle_to_its_end(rehearsal: Rehearsal) -> None:
    rehearsal.wait_until_complete()
    with RoslibPlayer(rehearsal, "Ann") as ann, RoslibPlayer(rehearsal, "Bob") as bob, Eyes(rehearsal) as eyes:
        assert {ann.robot, bob.robot} <= {1, 2, 3}, "a robot's ID is its number"
        assert ann.robot == 1, "the one that finds the master by itself"
        told = rehearsal.machines["raspberrypi1"].container("laserbot-robot")["Config"]["Env"]
        assert not [setting for setting in told if setting.startswith(("LASERBOT_MASTER=", "ROS_MASTER_URI="))]
        start(ann, bob)
        assert shoot_to_the_end(ann, bob, eyes) == [100, 60, 20, 0]
        result = [(entry["place"], entry["name"], entry["life"]) for entry in until(lambda: bob.look()["result"])]
        assert result == [(1, "Ann", 100), (2, "Bob", 0)]
