"""When messages pass the points of the chain that others can see: ROS topics, and a spectator's socket at rosbridge."""

import asyncio
import contextlib
import json
import time
from typing import NamedTuple

import websockets

from laser_bot_battle.msg import GameStatus, Hit, Robot_msg
from laser_bot_battle.names import GAME_STATUS, command_topic, hit_topic
from tcpros.node import Node
from tcpros.specs import TypeSpec
from tests.support.battle import Battle
from tests.support.light_robots import InLoop
from tests.support.polling import until

LATE = 5.0  # s


class Passed(NamedTuple):
    """A message, at a moment (monotonic s)."""

    at: float
    what: object


class Taps(InLoop):
    """Of one robot, in a thread of its own. All lists grow while it is open."""

    def __init__(self, battle: Battle, robot: int) -> None:
        super().__init__()
        self.commands: list[Passed] = []  # of its wheels: (linear, angular)
        self.hits: list[Passed] = []
        self.lives: list[Passed] = []  # of all users, by name, on ROS
        self.told: list[Passed] = []  # the same at the socket
        self._node = Node("/bench_taps", f"http://127.0.0.1:{battle.ports['LASERBOT_ROS_PORT']}")
        self.do(self._open(battle.bridge, robot))

    async def _open(self, bridge: str, robot: int) -> None:
        await self._node.start()
        node = self._node
        node.subscribe(
            command_topic(robot), TypeSpec.of(Robot_msg), lambda data, _: note(self.commands, tuple(data[:2]))
        )
        node.subscribe(hit_topic(robot), TypeSpec.of(Hit), lambda data, _: note(self.hits, data))
        node.subscribe(GAME_STATUS, TypeSpec.of(GameStatus), lambda data, _: note(self.lives, lives_of(data)))
        self.keep(self._watch(bridge))

    async def _watch(self, bridge: str) -> None:
        async with websockets.connect(bridge) as socket:
            await socket.send(json.dumps({"op": "subscribe", "topic": GAME_STATUS}))
            async for message in socket:
                passed = time.monotonic()
                said = json.loads(message)
                if said["op"] == "publish":
                    self.told.append(Passed(passed, {user["name"]: user["life"] for user in said["msg"]["users"]}))

    async def leave(self) -> None:
        with contextlib.suppress(asyncio.CancelledError):
            await super().leave()
        await self._node.close()


def note(passed: list[Passed], what: object) -> None:
    passed.append(Passed(time.monotonic(), what))


def lives_of(data: bytes) -> dict[str, int]:
    return {user.name: user.life for user in GameStatus().deserialize(data).users}


def first_after(passed: list[Passed], moment: float) -> float:
    """When the first one passed since `moment`: the tap itself may be a little late."""
    return until(lambda: next((one.at for one in passed if one.at >= moment), None), LATE, "it passes a tap")


def first_change(passed: list[Passed], name: str, moment: float) -> float:
    """When the life of that user was first another one than at `moment`."""
    before = [one for one in passed if one.at < moment][-1].what[name]  # type: ignore[index]

    def changed() -> float | None:
        after = (one for one in passed if one.at >= moment)
        return next((one.at for one in after if one.what.get(name) != before), None)  # type: ignore[attr-defined]

    return until(changed, LATE, "a changed life passes a tap")
