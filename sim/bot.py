"""`python3 -m sim.bot`: a player for whom there is no person. It uses only what a browser can use."""

import argparse
import asyncio
import contextlib
import logging
import os
import random
import sys
from typing import NoReturn

import aiohttp

from laser_bot_battle.announcement import NoArenaError
from laser_bot_battle.lifecycle import first_of, live_until, signalled
from laser_bot_battle.log import configure_logging
from laser_bot_battle.names import BOT_PREFIX, Game, is_bot
from laser_bot_battle.place import Place, find_again, locate
from laser_bot_battle.settings import describe, read_or_exit
from sim.bot_game import RETRY, Arena, Eyes, GameError, Player, Rosbridge, Status, Web
from sim.bot_mind import NEUTRAL, SKILLS, Command, Mind
from sim.bot_paths import Paths
from sim.bot_settings import VARIABLES, Settings, first_free

TICK = 0.04  # s between two commands
HEARTBEAT = 1.0  # s between two signs of life
READY_PAUSE = 0.5  # s between two calls that change ready
GOODBYE_SECONDS = 2.0
GONE_AFTER = 5.0  # s without an answer of the server; it may be at another address then

HELP = f"""\
A bot's name is {BOT_PREFIX} and a number; if it is taken, the bot tries the next one.
It is ready while a person is ready.

{describe(*VARIABLES)}
"""

_log = logging.getLogger(__name__)


class SignedOutError(Exception):
    """The server no longer knows this player."""


def fights(status: Status, me: Player) -> bool:
    """Whether this player may drive in a battle now."""
    return status.game == Game.PLAYING and not status.paused and me.ready and me.life > 0


def wants_ready(status: Status) -> bool:
    """Whether a bot is ready to play: while a person is."""
    return any(player.ready and not is_bot(player.name) for player in status.players)


class Bot:
    """Signs up and plays at a master's; whatever it loses there, it starts again."""

    def __init__(self, http: aiohttp.ClientSession, settings: Settings, place: Place) -> None:
        self._http = http
        self._settings = settings
        self._place = place
        self._web = Web(http, settings.web_url(place))
        self._eyes = Eyes(http, settings.view_url(place))
        self._name = ""
        self._told = ""
        self._arena: Arena | None = None
        self._mind: Mind | None = None
        self._hit_at: dict[int, float] = {}  # by robot
        self._last_hit = 0  # its number

    async def run(self) -> Place:
        """Play until cancelled, or until the arena has moved: returns where to; sign out in any case."""
        try:
            return await first_of(self._eyes.watch(), self._play_for_ever(), self._look_out())
        finally:
            await self._say_goodbye()

    async def _look_out(self) -> Place:
        """Where the arena is, once it has moved. A place that somebody has given is kept."""
        while True:
            await asyncio.sleep(RETRY)
            if self._place.arena and self._web.silence >= GONE_AFTER:
                _log.info("the server is gone: looking for arena %r at another address", self._place.arena)
                place = await self._look_while_gone()
                if place:
                    return place

    async def _look_while_gone(self) -> Place | None:
        search = asyncio.ensure_future(find_again(self._place.arena, self._place))
        try:
            while self._web.silence >= GONE_AFTER:
                if search.done():
                    return search.result()
                await asyncio.sleep(TICK)
        finally:
            search.cancel()
            await asyncio.gather(search, return_exceptions=True)
        return None

    async def _play_for_ever(self) -> NoReturn:
        while True:
            robot = await self._sign_up()
            try:
                await first_of(self._stay_signed_in(), self._use_rosbridge(robot))
            except SignedOutError:
                self._tell(f"{self._name} is signed out (the robot or the server was lost); signing up again")
                self._name = ""

    async def _sign_up(self) -> int:
        """Try until there is a name and a robot; returns the robot's ID. It looks first: the server counts sign-ups."""
        wanted = self._settings.robot
        none_free = "no robot is free; waiting" if wanted is None else f"robot {wanted} is not free; waiting"
        refused: set[str] = set()  # names that nobody has who can be seen
        while True:
            try:
                free, names = await self._web.look()
                if not free or (wanted is not None and wanted not in free):
                    self._tell(none_free)
                    await asyncio.sleep(RETRY)
                    continue
                name = first_free(self._settings.name, names | refused)
                answer = await self._web.sign_up(name, wanted)
            except GameError as error:
                self._tell(f"{error}; waiting")
            else:
                match answer.get("status"), answer.get("robot"):
                    case "OK", int(robot):
                        self._name = name
                        self._tell(f"signed up as {name}, driving robot {robot}")
                        return robot
                    case "UNAVAILABLE", _:
                        refused.add(name)
                        await asyncio.sleep(random.uniform(0, RETRY))  # bots that start together go apart
                        continue
                    case (("NO_ROBOTS" | "ROBOT_UNAVAILABLE"), _):
                        self._tell(none_free)
                    case _:
                        self._tell(f"cannot sign up: {answer}; trying again")
                refused.clear()
            await asyncio.sleep(RETRY)

    async def _stay_signed_in(self) -> None:
        """Give signs of life; SignedOutError when the server no longer knows the player."""
        while True:
            try:
                if not await self._web.is_signed_in(self._name):
                    raise SignedOutError
            except GameError as error:
                self._tell(f"{error}; waiting")
            await asyncio.sleep(HEARTBEAT)

    async def _use_rosbridge(self, robot: int) -> None:
        """Play through rosbridge for ever, also when it is restarted."""
        url = self._settings.rosbridge_url(self._place)
        while True:
            try:
                async with self._http.ws_connect(url, heartbeat=5) as socket:
                    rosbridge = Rosbridge(socket, robot)
                    await rosbridge.start()
                    self._tell(f"connected to rosbridge at {url}")
                    await first_of(self._play(rosbridge, robot), rosbridge.follow())
                self._tell("rosbridge has closed the connection; connecting again")
            except (aiohttp.ClientError, TimeoutError, OSError):
                self._tell(f"no rosbridge at {url}; waiting")
            await asyncio.sleep(RETRY)

    async def _play(self, rosbridge: Rosbridge, robot: int) -> None:
        """Drive while the battle lasts, agree on ready while it does not."""
        next_ready = 0.0
        loop = asyncio.get_running_loop()
        while True:
            status = rosbridge.status
            me = next((player for player in status.players if player.name == self._name), None) if status else None
            if status:
                self._note_hits(status, loop.time())
            if status and me and fights(status, me):
                opponents = {p.robot for p in status.players if p.ready and p.life > 0 and p is not me}
                await rosbridge.command(self._decide(loop.time(), robot, opponents, status.protection))
            else:  # rosbridge itself stops a robot whose driver may no longer drive
                self._mind = None
                due = loop.time() > next_ready
                if status and me and due and status.game != Game.PLAYING and me.ready != wants_ready(status):
                    next_ready = loop.time() + READY_PAUSE
                    await self._set_ready(not me.ready)
            await asyncio.sleep(TICK)

    async def _set_ready(self, ready: bool) -> None:
        try:
            await self._web.set_ready(self._name, ready)
            _log.info("%s is %s", self._name, "ready" if ready else "no longer ready")
        except GameError as error:
            self._tell(f"{error}; waiting")

    def _decide(self, now: float, robot: int, opponents: set[int], protection: float) -> Command:
        """What to do now, when nobody can be hit for `protection` s; nothing while the arena does not answer."""
        robots = dict(self._eyes.robots())
        me = robots.pop(robot, None)
        arena = self._eyes.arena
        if me is None or arena is None:
            return NEUTRAL
        if self._mind is None or arena is not self._arena:
            self._arena = arena
            paths = Paths(arena.width, arena.height, arena.walls)
            self._mind = Mind(paths, random.Random(), SKILLS[self._settings.level])
        points = {number: pose.point for number, pose in robots.items()}
        return self._mind.decide(now, me, points, opponents, self._hit_at, protection=protection)

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


async def play(http: aiohttp.ClientSession, settings: Settings) -> None:
    """Find the master and play there, until cancelled."""
    place = settings.place or await find_master(settings.arena)
    while True:
        _log.info("%s", place)
        place = await Bot(http, settings, place).run()


async def find_master(arena: str) -> Place:
    """Look until there is one, in the environment's ways."""
    told = ""
    while True:
        try:
            return await locate(os.environ, arena)
        except NoArenaError as error:
            if str(error) != told:
                _log.warning("%s; waiting", error)
            told = str(error)
        await asyncio.sleep(RETRY)


async def run(settings: Settings) -> None:
    """Play until SIGINT or SIGTERM."""
    jar = aiohttp.CookieJar(unsafe=True)  # unsafe: also keeps cookies of hosts that are given as IP addresses
    end = signalled()
    http = aiohttp.ClientSession(cookie_jar=jar, timeout=aiohttp.ClientTimeout(total=3))
    async with http, asyncio.TaskGroup() as tasks:
        playing = tasks.create_task(play(http, settings))
        await live_until(end)
        playing.cancel()


def main() -> int:
    """Exit code 0 after a signal, 2 for an impossible setting."""
    parser = argparse.ArgumentParser(
        "sim.bot", description=__doc__, epilog=HELP, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--name", default=f"{BOT_PREFIX}1", help="the player's name (default %(default)s)")
    parser.add_argument("--robot", metavar="ID", help="drive this robot (default: the first that is free)")
    parser.add_argument("--master", help="host of the web server (default: LASERBOT_MASTER, else it is looked for)")
    parser.add_argument("--rosbridge", metavar="HOST:PORT", help="rosbridge (default: on the master)")
    parser.add_argument("--arena", metavar="HOST:PORT", help="the arena's page (default: on the master's host)")
    arguments = parser.parse_args()
    settings = read_or_exit("bot", lambda env: Settings.read(env, **vars(arguments)))
    configure_logging(settings.log_level)
    asyncio.run(run(settings))
    return 0


if __name__ == "__main__":
    sys.exit(main())
