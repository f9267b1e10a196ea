"""How long a robot stands when a part of the battle is killed or hangs: 3 virtual robots, all in one battle.

Run by `make bench`. An operator drives a player's robot in circles, also when it is out of the battle, and connects
again as the page does. Measured is the time from the fault until the robot turns, and goes on turning for 5 s.
"""

import contextlib
import itertools
import math
import os
import signal
import threading
import time
from collections.abc import Callable

import psutil
from websockets.exceptions import WebSocketException

from tests.support.battle import Battle
from tests.support.player import Eyes, Player, WebSocketBridge

WITHIN = 60.0  # s
STEADY = 5.0  # s without a gap
GAP = 0.35  # s in which a robot that is driven turns by far more than TURN
TURN = 0.05  # rad
SHOWN = 3.0  # s within which a fault shows
SETTLED = 12.0  # s between two faults: what has worked for 10 s is started again at once
RECONNECT = 0.25  # s, as the page

TOKEN = "the operators' token"
RULES = {
    "LASERBOT_HIT_DAMAGE": "1",
    "LASERBOT_COUNTDOWN": "1",
    "LASERBOT_BATTLE_LIMIT": "3600",
    "LASERBOT_OPERATOR_TOKEN": TOKEN,
}


class OperatorBridge(WebSocketBridge):
    """It may drive any robot at any time."""

    def __init__(self, url: str, robot: int) -> None:
        super().__init__(url, robot, "")
        self._send("auth", mac=TOKEN, client="operator", dest="", rand="", t=0, level="", end=0)


class Driver:
    """Holds a key, and watches the robot turn."""

    def __init__(self, battle: Battle, robot: int) -> None:
        self._battle, self._robot = battle, robot
        self._end = threading.Event()
        self.turned_at = [time.monotonic()]
        self._threads = [threading.Thread(target=work) for work in (self._drive, self._watch)]
        for thread in self._threads:
            thread.start()

    def stop(self) -> None:
        self._end.set()
        for thread in self._threads:
            thread.join()

    def _drive(self) -> None:
        while not self._end.wait(RECONNECT):
            with contextlib.suppress(OSError, WebSocketException):
                bridge = OperatorBridge(self._battle.bridge, self._robot)
                while not self._end.wait(0.025):
                    bridge.publish({"linear_x": 0, "angular_z": 1, "shoot": False})
                bridge.close()

    def _watch(self) -> None:
        heading = math.nan
        while not self._end.is_set():
            with contextlib.suppress(OSError, WebSocketException), Eyes(self._battle) as eyes:
                while not self._end.wait(0.05):
                    robot = eyes.robots().get(self._robot)
                    if robot is None:
                        continue
                    turned = abs(math.remainder(robot["heading"] - heading, math.tau))
                    if not turned < TURN:
                        heading = robot["heading"]
                        self.turned_at.append(time.monotonic())
            self._end.wait(0.1)

    def back_after(self, fault: float) -> float | None:
        """s from `fault` to the end of the last gap; None if it does not come back."""
        while time.monotonic() < fault + WITHIN:
            time.sleep(0.2)
            now = time.monotonic()
            moments = [fault, *[moment for moment in self.turned_at if moment > fault], now]
            gaps = [(later - earlier, later) for earlier, later in itertools.pairwise(moments)]
            end = max((later for gap, later in gaps if gap > GAP), default=fault)
            if now - end >= STEADY + (SHOWN if end == fault else 0.0):
                return end - fault
        return None


def main() -> None:
    with Battle(3, 0, **RULES) as battle, contextlib.ExitStack() as stack:
        players = [stack.enter_context(Player(battle, name)) for name in ("Ann", "Bob", "Cy")]
        for player in players:
            player.ready()
        players[0].wait_for_game(2)
        driver = Driver(battle, players[0].robot)
        stack.callback(driver.stop)
        robot = players[0].robot
        node = rf"robot\.serial_node .*__name:=Robot{robot} "

        def worker() -> int:
            return int(psutil.Process(battle.pid(node)).ppid())

        def keeper() -> int:
            return int(psutil.Process(worker()).ppid())

        def programs(*patterns: str) -> Callable[[], list[int]]:
            return lambda: [battle.pid(pattern) for pattern in patterns]

        web, bridge, ros = r"python3 -m server\.main", r"python3 -m server\.rosbridge", r"server\.ros\.master"
        faults = {
            "serial node killed": (programs(node), signal.SIGKILL, 5),
            "ROS master killed": (programs(ros), signal.SIGKILL, 6),
            "ID client killed": (lambda: [worker()], signal.SIGKILL, 5),
            "ID client and its keeper killed": (lambda: [keeper()], signal.SIGKILL, 5),
            "rosbridge killed": (programs(bridge), signal.SIGKILL, 3),
            "game server killed": (programs(web), signal.SIGKILL, 3),
            "arena killed": (programs(r"python3 -m sim\.arena"), signal.SIGKILL, 5),
            "all of the master ended": (programs(web, bridge, ros), signal.SIGTERM, 6),
            "ID client hangs": (lambda: [worker()], signal.SIGSTOP, 8),
        }
        print(f"{'':<34} back after  (wanted)  the battle", flush=True)
        for name, (pids, number, wanted) in faults.items():
            time.sleep(SETTLED)
            victims = pids()
            fault = time.monotonic()
            for pid in victims:
                os.kill(pid, number)
            seconds = driver.back_after(fault)
            took = "never" if seconds is None else f"{seconds:6.1f} s"
            print(f"{name:<34} {took:>10}  ({wanted} s)     {kept(players[0])}", flush=True)
            if seconds is None:
                break


def kept(player: Player) -> str:
    """What has become of the seat and the fight."""
    with contextlib.suppress(OSError, WebSocketException):
        player.connect()
        player.wait_for_game(2)
        user = player.user()
        if user and user["ready"] and user["robot"] == player.robot:
            return "goes on"
    return "is over for its player"


if __name__ == "__main__":
    main()
