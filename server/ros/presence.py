"""Which robots are on their topics, as the ROS master knows it: only those can be driven and hit."""

import asyncio
import logging
from collections.abc import Iterable, Sequence
from itertools import islice
from urllib.parse import urlsplit

from laser_bot_battle.master import Master, MasterError
from laser_bot_battle.master_probe import is_master
from laser_bot_battle.names import command_topic, response_topic
from server.game.loop import GameLoop
from server.ros.robots_follower import RobotsFollower

_log = logging.getLogger(__name__)

PERIOD = 1.0  # s; a registration is followed by a look at once
MAX_NODES = 4  # that are asked for a robot: it has one


class Presence(RobotsFollower):
    """While the master does not answer, all stays as it was."""

    def __init__(self, game: GameLoop, master: Master) -> None:
        super().__init__(PERIOD)
        self._game = game
        self._master = master
        self._linked: set[int] = set()  # those whose node has answered this program

    def _settle(self, present: Sequence[int]) -> None:
        if not present:
            return
        try:
            publishers, subscribers, _ = self._master.call("getSystemState")
        except (OSError, MasterError, ValueError) as error:
            _log.debug("the ROS master does not say who is on which topics: %s", error)
            return
        found = drivers(present, publishers, subscribers)
        # the master also lists nodes that have ended without a word
        new = {robot: nodes for robot, nodes in found.items() if robot not in self._linked}
        self._linked = (found.keys() - new.keys()) | asyncio.run(self._answering(new))
        self._game.robots_linked(self._linked)

    async def _answering(self, nodes: dict[int, set[str]]) -> set[int]:
        """The robots with a node that answers. All are asked at once: the slow ones hold up nobody for long."""
        asked = [(robot, node) for robot, names in nodes.items() for node in islice(sorted(names), MAX_NODES)]
        answers = await asyncio.gather(*(self._answers(node) for _, node in asked))
        return {robot for (robot, _), answer in zip(asked, answers, strict=True) if answer}

    async def _answers(self, node: str) -> bool:
        try:
            url = urlsplit(await asyncio.to_thread(self._master.call, "lookupNode", node))
            return await is_master(url.hostname or "", url.port or 0)  # nodes have getPid, too
        except (OSError, MasterError, TypeError, ValueError):
            return False


Topics = Iterable[tuple[str, Sequence[str]]]  # names, and the nodes there


def drivers(robots: Iterable[int], publishers: Topics, subscribers: Topics) -> dict[int, set[str]]:
    """By robot, the nodes that listen to its commands and tell of its hits. Without such a node it is not there."""
    commanded, responding = dict(subscribers), dict(publishers)
    nodes = {
        robot: set(commanded.get(command_topic(robot), ())) & set(responding.get(response_topic(robot), ()))
        for robot in robots
    }
    return {robot: found for robot, found in nodes.items() if found}
