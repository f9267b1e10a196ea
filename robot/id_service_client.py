"""The robot's main program: finds the Arduino, gets an ID from the server, and keeps the robot in the battle.

    python3 -m robot.id_service_client

The master is found first, as the settings or else the network say (docs/discovery.md). The Arduino is asked next, so
that the server never offers players a robot that cannot move. Then the pings and the serial node Robot<ID> run until
the serial node ends; when the server has forgotten the robot, or one of them has another address, both start again.
Whatever fails is said in one line and tried again, for ever: at once, and more rarely only while it fails again and
again. A serial node that ends is started again while the pings go on: the robot keeps its player.
With LASERBOT_SERIAL=tcp-listen://address:port, boards connect to that port by themselves, and each is such a robot.
The status LED is lit from the start until the robot has an ID, blinks slowly while it works, and fast while it lacks
its Arduino, its ID or the server. SIGINT and SIGTERM end everything.
"""

import argparse
import asyncio
import contextlib
import logging
import secrets
import signal
import sys
import time
from collections.abc import Iterator
from typing import NoReturn

from robot.installed import missing_explained, require

with missing_explained():
    from laser_bot_battle import alive, variables
    from laser_bot_battle.announcement import NoArenaError
    from laser_bot_battle.backoff import STEADY, Backoff
    from laser_bot_battle.place import Place
    from laser_bot_battle.settings import describe
    from robot.board_server import BoardServer
    from robot.keeper import Heart, keep_going
    from robot.master_location import Lookout, MasterLocation, MovedError, ReaddressedError
    from robot.ping_thread import PingThread
    from robot.registration import RegistrationError, register
    from robot.rosserial.host import ANSWER_TIMEOUT
    from robot.serial.connection import is_inherited, listening_address
    from robot.serial.find_arduino import ArduinoLostError, find_arduino
    from robot.serial.port import NoAnswerError, PortError, probe
    from robot.serial_process import NO_ANSWER, SerialNode
    from robot.settings import Settings
    from robot.status_led import Indication, State, status_led

require(
    "rospy", "rosgraph", "genpy", "std_msgs", "laser_bot_battle.msg._Robot_msg"
)  # for the program that this one starts

PROGRAM = "robot.id_service_client"
POLL = 0.1  # s
LOOK = 1.0  # s between two looks at addresses, and two signs of life
LONGEST_START = 60.0  # s that the device may take to answer, in the end
LOST_AFTER = 2.0  # s without an answer to the pings; the master may be at another address then

_log = logging.getLogger(__name__)


def main() -> int:
    parser = argparse.ArgumentParser(
        prog=PROGRAM,
        description=__doc__,
        epilog=describe(
            variables.ARENA_NAME,
            variables.MASTER,
            variables.WEB,
            variables.ROS_MASTER_URI,
            variables.INTERFACE,
            variables.SERIAL,
            variables.ROBOT_NAME,
            variables.RETRY,
            variables.LED,
            variables.CAMERA,
            variables.CAMERA_PORT,
            variables.CAMERA_URL,
            variables.ALIVE_FILE,
            variables.PRIORITY,
            variables.LOG_LEVEL,
            variables.LOG_FORMAT,
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    # roslaunch adds ROS arguments such as __name:=...
    parser.parse_args([word for word in sys.argv[1:] if ":=" not in word])
    settings = Settings.load(PROGRAM)
    heart = keep_going()
    if address := listening_address(settings.devices):
        return asyncio.run(BoardServer(PROGRAM, heart).run(*address))
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell starts background programs with it ignored
    signal.signal(signal.SIGTERM, interrupt_once)
    try:
        with status_led(settings.led) as led, ending_once():
            Robot(settings, MasterLocation(settings), led, heart).run()
    except KeyboardInterrupt:
        _log.info("ending")
    return 0


def interrupt_once(*_: object) -> None:
    """As SIGINT; whoever is impatient and sends more than one does not interrupt the end."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    signal.raise_signal(signal.SIGINT)


@contextlib.contextmanager
def ending_once() -> Iterator[None]:
    """Once it is left, signals no longer matter: the program ends anyway, and nothing is left half ended."""
    try:
        yield
    finally:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)


class Robot:
    """Lives again and again, as often as it takes."""

    def __init__(self, settings: Settings, location: MasterLocation, led: Indication, heart: Heart) -> None:
        self._settings = settings
        self._location = location
        self._led = led
        self._heart = heart
        self._backoff = Backoff(settings.retry)
        self._answer_within = ANSWER_TIMEOUT

    def run(self) -> None:
        """For ever or, of a board that has connected by itself, until that does not answer."""
        while True:
            _log.info("Starting service client ...")
            try:
                self._live()
            except (ArduinoLostError, NoArenaError, PortError, RegistrationError) as error:
                self._led.state = State.FAILING
                if isinstance(error, ArduinoLostError | PortError) and is_inherited(self._settings.devices[0]):
                    _log.error("%s: the connection ends", error)
                    return
                pause = self._backoff.failed()
                _log.error("%s (again in %g s)", error, pause)
            self._location.rest(pause)

    def _live(self) -> NoReturn:
        """One life, from finding the master to losing the Arduino; always ends with an exception: why."""
        place = self._location.locate()
        device = find_arduino(self._settings.devices)
        _log.info("asking the Arduino at %s", device)
        self._probe(device)
        key = secrets.token_urlsafe()  # by which the server tells this robot's pings from others'
        robot_id = register(place.ros_master_uri, self._settings.caller_id, key, wanted=lambda: True)
        registered = True
        while True:
            with SerialNode(device, robot_id, place) as node, Lookout(place) as lookout:
                try:
                    if not registered:
                        last, robot_id = robot_id, self._register_again(node, place, key, lookout)
                        registered = True
                        if robot_id != last:
                            continue  # under its new name
                    _log.info("New robot ID = %d", robot_id)
                    self._location.join(place)
                    with PingThread(f"http://{place.host}:{place.web}/incAlive", robot_id, key) as pings:
                        self._supervise(node, pings, lookout)
                    _log.warning("the server does not know robot %d: registering again", robot_id)
                except MovedError as moved:
                    _log.warning("%s; it was at %s: registering again", moved, place.host)
                    place = moved.place
                except ReaddressedError as error:
                    _log.warning("%s: registering again", error)
                self._led.state = State.FAILING
                # Restart the node: after an outage its subscriber may hold a connection whose other end was closed.
                # Until it notices, rospy takes the next player's connection for that one.
                registered = False

    def _probe(self, device: str) -> None:
        """As `probe`. A device that has not answered gets more time after each attempt: opening the port resets it,
        perhaps again and again just before it would have answered."""
        try:
            probe(device, self._answer_within)
        except NoAnswerError as error:
            self._answer_within = min(2 * self._answer_within, LONGEST_START)
            told = f"{error}; the next attempt may reset it, and gives it {self._answer_within:g} s"
            raise NoAnswerError(told) from None
        self._answer_within = ANSWER_TIMEOUT

    def _supervise(self, node: SerialNode, pings: PingThread, lookout: Lookout) -> None:
        """Watch a working robot until the server has forgotten it; a server that does so at once is not asked in a
        rush.

        ArduinoLostError when the serial node ends soon after its start, or its device is gone, MovedError when the
        server has gone to another address, ReaddressedError when this robot has.
        """
        look_at, not_before = 0.0, time.monotonic() + self._settings.retry
        try:
            while True:
                now = time.monotonic()
                self._led.state = State.WORKING if pings.welcome else State.FAILING
                if node.exit_code is not None:
                    start_again(node)
                if pings.unknown.is_set() and now >= not_before:
                    return
                if now >= look_at:
                    look_at = now + LOOK
                    self._heart.rest()  # a name server may be out of reach
                    lookout.watch(lost=pings.silence >= LOST_AFTER)
                    self._heart.beat()
                    if pings.welcome:
                        alive.touch()
                    if node.age >= ANSWER_TIMEOUT + STEADY:
                        self._backoff.worked()
                time.sleep(POLL)
        finally:
            self._heart.rest()

    def _register_again(self, node: SerialNode, place: Place, key: str, lookout: Lookout) -> int:
        """Ask until there is an ID, while the new serial node starts: so the robot moves soon after players may have
        it.

        ArduinoLostError when the serial node ends, MovedError when the server has gone to another address,
        ReaddressedError when this robot has.
        """
        ask_at, failed, backoff = 0.0, False, Backoff(self._settings.retry)

        def wanted() -> bool:
            lookout.watch(lost=failed)
            return node.exit_code is None

        while wanted():
            if time.monotonic() >= ask_at:
                try:
                    return register(place.ros_master_uri, self._settings.caller_id, key, wanted)
                except RegistrationError as error:
                    failed, pause = True, backoff.failed()
                    if node.exit_code is None:
                        _log.error("%s (again in %g s)", error, pause)
                    ask_at = time.monotonic() + pause
            time.sleep(POLL)
        raise ArduinoLostError(lost(node))


def start_again(node: SerialNode) -> None:
    """ArduinoLostError when that is of no use."""
    reason = lost(node)
    if node.age < STEADY or node.exit_code == NO_ANSWER:
        raise ArduinoLostError(reason)
    find_arduino((node.device,))
    _log.error("%s: starting it again", reason)
    node.start_again()


def lost(node: SerialNode) -> str:
    return f"Connection to Arduino lost: the serial node ended with exit code {node.exit_code}"


if __name__ == "__main__":
    sys.exit(main())
