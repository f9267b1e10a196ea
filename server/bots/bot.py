"""One bot: a player for whom there is no person. It uses only what a browser can use."""

import asyncio
import contextlib
import logging
import random
from typing import Any, NoReturn

from laser_bot_battle.geometry import Pose
from laser_bot_battle.lifecycle import first_of
from laser_bot_battle.names import Game
from server.bots.bridge import AWAY, RETRY, Feed, Wheel, connected
from server.bots.game import Floor, Player, Status, fights, wants_ready
from server.bots.mind import NEUTRAL, SKILLS, Command, Mind
from server.bots.paths import Paths
from server.bots.settings import first_free
from server.bots.sight import OwnWay
from server.bots.web import GameError, Web

TICK = 0.04  # s between two commands
HEARTBEAT = 1.0  # s between two signs of life
READY_PAUSE = 0.5  # s between two calls that change ready
GOODBYE_SECONDS = 2.0

_log = logging.getLogger(__name__)


class SignedOutError(Exception):
    """The server no longer knows this player."""


class Bot:
    """Drives a robot at a master's whenever it can have it, until it is signed out there."""

    def __init__(self, web: Web, feed: Feed, robot: int, level: str, names: asyncio.Lock) -> None:
        """Who has `names` chooses one: two bots that look at the same time would choose the same."""
        self.level = level
        """how good it is, one of SKILLS; another one holds from the next battle on"""
        self._web, self._feed, self._robot, self._names = web, feed, robot, names
        self._name = ""
        self._told = ""
        self._was_blind = False
        self._floor: Floor | None = None
        self._paths: Paths | None = None  # on it
        self._mind: Mind | None = None
        self._way = OwnWay()
        self._hit_at: dict[int, float] = {}  # by robot
        self._last_hit = 0  # its number

    async def run(self) -> None:
        """Play until cancelled, or signed out by somebody else; in any case, the robot is free then."""
        try:
            await self._sign_up()
            await first_of(self._stay_signed_in(), self._use_rosbridge())
        except SignedOutError:
            self._tell(f"{self._name} is signed out (the robot or the server was lost, or somebody wants the robot)")
            self._name = ""
        finally:
            await self._say_goodbye()

    async def _sign_up(self) -> None:
        """Try until there is a name and the robot. It looks first: the server counts sign-ups."""
        refused: set[str] = set()  # names that nobody has who can be seen
        while not self._name:
            try:
                async with self._names:
                    free, names = await self._web.look()
                    answer = {}
                    if self._robot in free:
                        name = first_free(names | refused)
                        answer = await self._claim(name)
            except GameError as error:
                self._tell(f"{error}; waiting")
            else:
                match answer.get("status"):
                    case "OK":
                        self._name = name
                        return self._tell(f"signed up as {name}, driving robot {self._robot}")
                    case "UNAVAILABLE":
                        refused.add(name)
                        await asyncio.sleep(random.uniform(0, RETRY))  # bots of two programs go apart
                        continue
                    case None | "NO_ROBOTS" | "ROBOT_UNAVAILABLE":
                        self._tell(f"robot {self._robot} is not free; waiting")
                    case _:
                        self._tell(f"cannot sign up: {answer}; trying again")
                refused.clear()
            await asyncio.sleep(RETRY)

    async def _claim(self, name: str) -> dict[str, Any]:
        """The answer to a sign-up. Whoever ends it meanwhile waits for it: the seat is to be given back then."""
        claim = asyncio.ensure_future(self._web.sign_up(name, self._robot))
        try:
            return await asyncio.shield(claim)
        except asyncio.CancelledError:
            with contextlib.suppress(GameError):
                if (await claim).get("status") == "OK":
                    self._name = name
            raise

    async def _stay_signed_in(self) -> None:
        """Give signs of life; SignedOutError when the server no longer knows the player."""
        while True:
            try:
                if not await self._web.is_signed_in(self._name):
                    raise SignedOutError
            except GameError as error:
                self._tell(f"{error}; waiting")
            await asyncio.sleep(HEARTBEAT)

    async def _use_rosbridge(self) -> None:
        """Play through rosbridge for ever, also when it is restarted."""
        while True:
            try:
                async with connected(self._feed.url, self._web.cookies) as socket:
                    wheel = Wheel(socket, self._robot)
                    await wheel.start()
                    self._tell(f"{self._name} is connected to rosbridge at {self._feed.url}")
                    await first_of(self._play(wheel), wheel.hold())
                self._tell("rosbridge has closed the connection; connecting again")
            except AWAY:
                self._tell(f"no rosbridge at {self._feed.url}; waiting")
            await asyncio.sleep(RETRY)

    async def _play(self, wheel: Wheel) -> NoReturn:
        """Drive while the battle lasts, agree on ready while it does not."""
        next_ready = 0.0
        loop = asyncio.get_running_loop()
        while True:
            await self._learn_floor()
            now, status = loop.time(), self._feed.status
            sees = self._sees(now)
            me = status.player(self._name) if status else None
            if status:
                self._note_hits(status, now)
            if status and me and fights(status, me):
                command = self._decide(now, status, me)
                await wheel.command(command)
                self._way.commanded(now, command)
            else:  # rosbridge itself stops a robot whose driver may no longer drive
                self._mind = None
                due = now > next_ready
                wanted = status is not None and sees and wants_ready(status)
                if status and me and due and status.game != Game.PLAYING and me.ready != wanted:
                    next_ready = now + READY_PAUSE
                    await self._set_ready(wanted)
            await asyncio.sleep(TICK)

    async def _learn_floor(self) -> None:
        floor = self._feed.sight.floor
        if floor is not None and floor is not self._floor:
            self._paths = await self._feed.paths_on(floor)
            self._floor, self._mind = floor, None

    async def _set_ready(self, ready: bool) -> None:
        try:
            await self._web.set_ready(self._name, ready)
            _log.info("%s is %s", self._name, "ready" if ready else "no longer ready")
        except GameError as error:
            self._tell(f"{error}; waiting")

    def _sees(self, now: float) -> bool:
        """Whether its own robot can be seen; it says what has changed."""
        is_blind = self._feed.status is not None and self._feed.sight.seen(self._robot, now) is None
        if is_blind is not self._was_blind:
            self._was_blind = is_blind
            if is_blind:
                _log.warning("/positions does not say where robot %d is: %s is waiting", self._robot, self._name)
            else:
                _log.info("%s sees robot %d", self._name, self._robot)
        return not is_blind

    def _decide(self, now: float, status: Status, me: Player) -> Command:
        """What to do now; nothing while the robot cannot be seen."""
        sight = self._feed.sight
        seen = sight.seen(self._robot, now)
        if seen is None or self._paths is None:
            return NEUTRAL
        if self._mind is None:
            self._mind = Mind(self._paths, random.Random(), SKILLS[self.level])
        others = {robot: point for robot, point in sight.points(now).items() if robot != self._robot}
        opponents = {player.robot for player in status.players if player.ready and player.life > 0} - {self._robot}
        pose: Pose = self._way.since(*seen, now)
        return self._mind.decide(now, pose, others, opponents, self._hit_at, protection=status.protection)

    def _note_hits(self, status: Status, now: float) -> None:
        robots = {player.name: player.robot for player in status.players}
        for number, name in status.hits:
            if number > self._last_hit and name in robots:
                self._hit_at[robots[name]] = now
        self._last_hit = max((number for number, _ in status.hits), default=0)

    async def _say_goodbye(self) -> None:
        """rosbridge stops a robot whose driver's connection closes; the name and the robot are given back here."""
        if self._name:
            with contextlib.suppress(GameError, TimeoutError):
                async with asyncio.timeout(GOODBYE_SECONDS):
                    await self._web.sign_out(self._name)
                    _log.info("%s has signed out", self._name)

    def _tell(self, text: str) -> None:
        """Log what has changed: the same text only once."""
        if text != self._told:
            _log.info("%s", text)
        self._told = text
