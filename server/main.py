"""The game server of the master (manual 3.1.1): referee, web server and the ROS node `robots_server` in one process."""

import argparse
import contextlib
import logging
import os
import signal
import socket
import sys
import threading
from types import FrameType
from typing import NoReturn

import rospy
import waitress

from server.app import create_app
from server.battle import Battle
from server.id_service_server import IdServiceServer
from server.logs import configure_logging
from server.master_watch import MasterWatch, wait_for_master
from server.referee import Referee
from server.roster import Roster
from server.settings import Settings, SettingsError
from server.tcpros_guard import guard_handshakes

_log = logging.getLogger(__name__)

NODE = "robots_server"

_END_WITHIN = 1.8  # s


class Server:
    """The running program. A signal ends it, and so does any thread that calls `fail`."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._exit_code = 0
        self._ending = False
        self._main_thread = threading.get_ident()

    def run(self) -> int:
        """Serve until a signal comes or something vital is lost; returns the exit code. For the main thread."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._interrupt)
        bind, port = self._settings.bind, self._settings.web_port
        try:
            listener = _bind(bind, port)
        except OSError as error:
            what = error.strerror or error
            _log.error("cannot listen at %s port %d: %s; free it or set LASERBOT_WEB_PORT or _BIND", bind, port, what)
            return 1
        with listener, contextlib.suppress(SystemExit):  # by _interrupt
            self._serve(listener)
        return self._exit_code

    def fail(self, reason: str) -> None:
        """End the program so that its supervisor starts it again. From any thread."""
        if not self._ending:
            _log.error("%s: ending, to be started again", reason)
            self._exit_code = 1
            signal.pthread_kill(self._main_thread, signal.SIGTERM)

    def _serve(self, listener: socket.socket) -> None:
        settings = self._settings
        roster = Roster(settings.data, settings.roster)
        battle = Battle(Referee(settings.rules, roster.load()))
        watch = MasterWatch(settings.master_uri, NODE, self.fail)
        try:
            wait_for_master(settings.master_uri, NODE)
            watch.start()
            guard_handshakes()
            rospy.init_node(NODE, disable_signals=True, disable_rosout=True)
            configure_logging(settings.log_level)
            rospy.on_shutdown(lambda: self.fail("ROS has shut this node down"))
            IdServiceServer(battle, roster)
            battle.start()
            web = waitress.create_server(
                create_app(battle, settings),
                sockets=[listener],
                threads=8,
                connection_limit=500,
                channel_timeout=30,
                asyncore_use_poll=True,  # select() ends at 1024 files
                max_request_body_size=1 << 20,  # what the application then refuses politely
            )
            _log.info("serving the game at http://%s:%d", settings.bind, settings.web_port)
            web.run()
        except (OSError, rospy.ROSException) as error:
            _log.error("%s: ending, to be started again", error)
            self._exit_code = 1
        finally:
            self._ending = True
            self._hurry()
            watch.stop()
            battle.stop()
            rospy.signal_shutdown("the server ends")

    def _interrupt(self, number: int, _frame: FrameType | None) -> NoReturn:
        for signal_number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(signal_number, signal.SIG_IGN)
        self._ending = True
        raise SystemExit(f"signal {number}")

    def _hurry(self) -> None:
        """rospy tells the master that it goes, without any time-out: a master that hangs must not hold us."""
        timer = threading.Timer(_END_WITHIN, os._exit, [self._exit_code])
        timer.daemon = True
        timer.start()


def _bind(address: str, port: int) -> socket.socket:
    """A socket that has the address but does not listen yet: until all is ready, connections are refused."""
    family, kind, protocol, _, place = socket.getaddrinfo(
        address, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
    )[0]
    listener = socket.socket(family, kind, protocol)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(place)
    except OSError:
        listener.close()
        raise
    return listener


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="server.main",
        description="The game server: referee, web server and the ROS node robots_server.",
        epilog="Settings are environment variables (ROS_MASTER_URI and LASERBOT_...), listed in README.md.",
    )
    parser.parse_args(rospy.myargv()[1:])
    try:
        settings = Settings.from_env(os.environ)
    except SettingsError as error:
        print(f"server.main: {error}", file=sys.stderr)
        return 2
    configure_logging(settings.log_level)
    return Server(settings).run()


if __name__ == "__main__":
    sys.exit(main())
