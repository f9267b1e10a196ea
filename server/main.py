"""The game server of the master (manual 3.1.1): referee, web server and the ROS node `robots_server` in one process."""

import logging
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from waitress import wasyncore

from laser_bot_battle.listening import Listener
from laser_bot_battle.log import configure_logging
from laser_bot_battle.master import Master
from laser_bot_battle.names import SERVER_NODE
from laser_bot_battle.settings import read_or_exit
from laser_bot_battle.watched import Owner, watched
from server.game.loop import GameLoop
from server.game.persistence import restore
from server.game.referee import Referee
from server.game.robot import Robots
from server.game.robot_health import RobotsHealth
from server.game.state import State
from server.program.program import Program, read_arguments
from server.ros.health_reports import HealthListener
from server.ros.hits import Hits
from server.ros.id_service_server import IdServiceServer
from server.ros.node import rospy_node
from server.ros.overhead import OverheadTroubles
from server.ros.positions import PositionsListener
from server.ros.presence import Presence
from server.ros.robot_commands import RobotCommands
from server.ros.status import StatusPublisher
from server.store.database import Database
from server.store.log import EventLog
from server.store.roster import Roster, take_over_file
from server.web.app import create_app
from server.web.bots import BotsProgram, create_bots
from server.web.fair_server import FairServer
from server.web.metrics import metrics
from server.web.operator import create_operator
from server.web.operator_access import Access
from server.web.operator_api import create_operator_api
from server.web.pages_process import PagesProcess
from server.web.pulse import Pulse
from server.web.routes import OwnRoutes
from server.web.settings import VARIABLES, Settings
from server.web.watch import create_watch

_log = logging.getLogger(__name__)

_CLOSE_WITHIN = 0.5  # s
_SWITCH = 0.001  # s; a robot's ping waits for Python's lock at every step, behind strangers' requests
_SERVER_STARTS = 5.0  # s that a database server may need longer than this program, after a power cut


def main() -> int:
    """The program; returns its exit code."""
    description = "The game server: referee, web server and the ROS node robots_server."
    environment = read_arguments("server.main", description, *VARIABLES)
    settings = read_or_exit("server.main", Settings.from_env, environment)
    configure_logging(settings.program.log_level)
    program = Program(SERVER_NODE, settings.program)
    sys.setswitchinterval(_SWITCH)
    return program.run(lambda listener: _serve(program, settings, listener))


@contextmanager
def _serve(program: Program, settings: Settings, listener: Listener) -> Iterator[None]:
    with rospy_node(program), _game(program, settings, listener):
        yield


@contextmanager
def _game(program: Program, settings: Settings, listener: Listener) -> Iterator[None]:
    roster = Roster(settings.roster)
    database = Database(settings.database, settings.arena)
    game = GameLoop(Referee(settings.rules, _state(database, roster, settings), settings.floor.zones))
    database.found = lambda kept: game.take_over(kept.state or {}, roster.with_fixed(kept.robots))
    log = EventLog(database)
    log.open()
    game.add_recorder(database.record)
    game.add_recorder(log.record)
    health = RobotsHealth()
    master = Master(settings.program.master_uri, SERVER_NODE)
    hits, commands, reports = Hits(game, master), RobotCommands(), HealthListener(health, master)
    positions = PositionsListener(database.keep_piece, game)
    presence = Presence(game, master)
    game.add_listener(StatusPublisher(health).publish)
    for robots in (hits, commands, reports, health):
        game.add_listener(robots.follow)
    game.add_listener(presence.follow)
    game.add_listener(positions.follow)
    IdServiceServer(game, roster)
    channels: dict[int, wasyncore.dispatcher] = {}
    access = Access(settings.operator_token)
    pages, bots, overhead = PagesProcess(), BotsProgram(), OverheadTroubles()
    overhead.follow()
    desk = create_operator_api(
        game,
        settings,
        access,
        database,
        log,
        health=health,
        bots=bots,
        overhead=overhead.now,
        identify=commands.identify,
        ask_audience=pages.tell,
    )
    more = create_watch(game, health), create_operator(access), desk, create_bots(game, bots)
    app = create_app(game, settings, *more, pages=pages)
    web = FairServer(app, listener, channels, OwnRoutes(app).lane, settings.proxies)
    game.add_listener(Pulse(web).follow)
    game.start()
    program.start_thread("hits", hits.run)
    program.start_thread("commands", commands.run)
    program.start_thread("health", reports.run)
    program.start_thread("presence", presence.run)
    program.start_thread("pages", pages.run)
    serving = program.start_thread("web server", web.run)
    _log.info("serving the game at http://%s:%d", settings.program.bind, settings.program.port)
    owner = Owner(lambda: metrics(game, health, hits.told(), hits.refused, database), lambda: _missing(game))
    try:
        with watched("web", settings.program.metrics, owner):
            yield
    finally:
        game.stop()
        positions.stop()
        database.close()
        with suppress(OSError):  # the loop was awake, and has closed the trigger before it was pulled
            web.trigger.pull_trigger(lambda: wasyncore.close_all(channels))  # in its thread: it may be accepting now
        serving.join(_CLOSE_WITHIN)
        pages.stop()
        for robots in (hits, commands, reports):
            robots.stop()
        presence.stop()


def _missing(game: GameLoop) -> str:
    """What the game lacks to be played: nothing, as long as its owner answers."""
    game.snapshot()
    return ""


def _state(database: Database, roster: Roster, settings: Settings) -> State:
    """The game as an earlier program has left it."""
    kept = database.open(patience=_SERVER_STARTS)
    known = kept.robots
    if not known and not database.problem:
        known = take_over_file(settings.data)
        database.keep_robots(known)
    robots = roster.with_fixed(known)
    if kept.state is not None:
        now = time.monotonic()
        pause = now - kept.saved_at
        try:
            state = restore(kept.state, robots, now, pause)
        except ValueError as error:
            _log.error("the state in the database is of no use, the game begins anew: %s", error)
        else:
            _log.info("the game goes on after %.1f s", pause)
            return state
    return State(robots=Robots(robots), battle=kept.battles)


if __name__ == "__main__":
    sys.exit(main())
