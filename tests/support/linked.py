"""Robots for tests of the game alone, without a ROS master that knows who is on which topics."""

from server.game.loop import GameLoop


def add_linked_robot(battle: GameLoop, caller: str = "/unnamed") -> int | None:
    """A robot that registers and is at once on its topics, as all that are there; its ID, as `GameLoop.add_robot`."""
    robot_id = battle.add_robot(caller)
    battle.robots_linked(battle.snapshot().robots)
    return robot_id
