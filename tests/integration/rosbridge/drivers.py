"""Four drivers at 40 commands a second, their robots and their referee; a process of its own, so that only rosbridge
can keep it waiting. `python -m tests.integration.rosbridge.drivers PORT`, with ROS_MASTER_URI set.

Says {"driving": true} once all robots get commands. Understands a line at a time: `join` lets one more player connect,
advertise and drive, and says {"joined": s}; the end of the input says {"sent", "lost", "p50", "p99", "worst"} (times in
s from the socket to the robot) and ends it.
"""

import asyncio
import contextlib
import io
import itertools
import json
import os
import statistics
import sys
import time
from collections import deque
from collections.abc import AsyncIterator
from typing import Any

import uvloop
from websockets.asyncio.client import ClientConnection, connect

from laser_bot_battle.msg import GameStatus, Robot_msg, UserStatus
from laser_bot_battle.names import GAME_STATUS, command_topic, session_digest
from tcpros.node import Node
from tcpros.publisher import Publisher
from tcpros.specs import TypeSpec

DRIVERS = 4
LATE, VILLAIN = DRIVERS, DRIVERS + 1  # players as well, with robots of these numbers
PERIOD = 1 / 40  # s
REFEREE_PERIOD = 0.3  # s
# What is sent, in this order again and again: from what arrives it can be told what is missing.
COMMANDS = [
    {"linear_x": x, "angular_z": z, "shoot": shoot} for x, z, shoot in itertools.product((-1, 0, 1), (-1, 0, 1), (0, 1))
]


def token(number: int) -> str:
    return f"token-of-{number}"


class Robot:
    """One player with a robot: what was sent and has not come yet, and how long the others took."""

    def __init__(self, node: Node, number: int) -> None:
        self.topic = command_topic(number)
        self.measuring = False
        self.arrived = asyncio.Event()
        self.sent = self.lost = 0
        self.latencies: list[float] = []
        self._under_way: deque[tuple[dict[str, Any], float]] = deque()
        node.subscribe(self.topic, TypeSpec.of(Robot_msg), self._receive)

    def request(self) -> str:
        """The next command, which is sent now."""
        command = COMMANDS[self.sent % len(COMMANDS)] | {}
        self.sent += 1
        self._under_way.append((command, time.monotonic()))
        return json.dumps({"op": "publish", "topic": self.topic, "msg": {**command, "shoot": bool(command["shoot"])}})

    def start(self) -> None:
        """From here on it counts."""
        self._under_way.clear()
        self.sent = self.lost = 0
        self.latencies.clear()
        self.measuring = True

    def finish(self) -> None:
        """What has not come by now is lost."""
        self.lost += len(self._under_way)

    def _receive(self, data: bytes, header: object) -> None:
        self.arrived.set()
        message = Robot_msg().deserialize(data)
        came = {"linear_x": message.linear_x, "angular_z": message.angular_z, "shoot": int(message.shoot)}
        while self.measuring and self._under_way:
            command, begin = self._under_way.popleft()
            if command == came:
                self.latencies.append(time.monotonic() - begin)
                return
            self.lost += 1


@contextlib.asynccontextmanager
async def seat(port: int, robot: Robot, number: int) -> AsyncIterator[ClientConnection]:
    """The player's socket, with the topic advertised."""
    headers = {"Cookie": f"laserbot_session={token(number)}"}
    async with connect(f"ws://127.0.0.1:{port}", additional_headers=headers, compression=None) as socket:
        await socket.send(json.dumps({"op": "advertise", "topic": robot.topic, "type": Robot_msg._type}))
        yield socket


async def drive(port: int, robot: Robot, number: int, ready: asyncio.Barrier, ending: asyncio.Event) -> None:
    async with seat(port, robot, number) as socket:
        while not robot.arrived.is_set():
            await socket.send(robot.request())
            await asyncio.sleep(PERIOD)
        await ready.wait()
        robot.start()
        due = time.monotonic() + number * PERIOD / DRIVERS
        while not ending.is_set():
            await asyncio.sleep(due - time.monotonic())
            due += PERIOD
            await socket.send(robot.request())
        await asyncio.sleep(1.0)  # for the last ones to arrive: more is as bad as lost
        robot.finish()


async def join(port: int, node: Node) -> float:
    """How long one more player needs from his page's opening to his robot's first command, in s."""
    begin = time.monotonic()
    robot = Robot(node, LATE)
    while not robot.arrived.is_set():
        with contextlib.suppress(OSError):
            async with seat(port, robot, LATE) as socket:
                while not robot.arrived.is_set():
                    await socket.send(robot.request())
                    await asyncio.sleep(PERIOD)
    return time.monotonic() - begin


async def referee(publisher: Publisher) -> None:
    users = [
        UserStatus(name=f"p{number}", robot=number, life=100, ready=True, session=session_digest(token(number)))
        for number in range(VILLAIN + 1)
    ]
    buffer = io.BytesIO()
    GameStatus(game=GameStatus.PLAYING, users=users).serialize(buffer)
    while True:
        publisher.publish(buffer.getvalue())
        await asyncio.sleep(REFEREE_PERIOD)


async def lines() -> AsyncIterator[str]:
    reader = asyncio.StreamReader()
    await asyncio.get_running_loop().connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
    while line := await reader.readline():
        yield line.decode().strip()


def say(**values: Any) -> None:
    print(json.dumps(values), flush=True)


async def main(port: int) -> None:
    node = Node("drivers", os.environ["ROS_MASTER_URI"])
    await node.start()
    robots = [Robot(node, number) for number in range(DRIVERS)]
    ready, ending = asyncio.Barrier(DRIVERS + 1), asyncio.Event()
    async with asyncio.TaskGroup() as group:
        refereeing = group.create_task(referee(node.advertise(GAME_STATUS, TypeSpec.of(GameStatus), latch=True)))
        driving = [group.create_task(drive(port, robot, number, ready, ending)) for number, robot in enumerate(robots)]
        await ready.wait()
        say(driving=True)
        async for line in lines():
            assert line == "join"
            say(joined=await join(port, node))
        ending.set()
        await asyncio.gather(*driving)
        refereeing.cancel()
    latencies = sorted(latency for robot in robots for latency in robot.latencies)
    cuts = statistics.quantiles(latencies, n=100)
    sent, lost = (sum(getattr(robot, what) for robot in robots) for what in ("sent", "lost"))
    say(sent=sent, lost=lost, p50=cuts[49], p99=cuts[98], worst=latencies[-1])
    await node.close()


if __name__ == "__main__":
    with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        runner.run(main(int(sys.argv[1])))
