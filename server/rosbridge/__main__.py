"""rosbridge: `python3 -m server.rosbridge`, the ROS node `rosbridge_websocket`."""

import argparse
import asyncio
import logging
import os
import signal
import socket
import sys
import threading

import rospy

from server.logs import configure_logging
from server.master_watch import MasterWatch, wait_for_master
from server.rosbridge.bridge import Bridge
from server.rosbridge.settings import Settings, SettingsError
from server.rosbridge.websocket import WebSocketServer
from server.tcpros_guard import guard_handshakes

_log = logging.getLogger("server.rosbridge")

NODE = "rosbridge_websocket"
# A command passes through two threads here. Python hands over between busy threads every 5 ms unless told otherwise,
# which alone would be half of what a command may take from key to coil.
SWITCH_INTERVAL = 0.0005  # s
# rospy's sending threads need a moment for the last neutral commands.
FLUSH = 0.1  # s
END_WITHIN = 1.0  # s, after the sockets are closed


def main() -> int:
    """The program; returns its exit code."""
    argparse.ArgumentParser(
        prog="python3 -m server.rosbridge",
        description="WebSocket server between browsers and ROS (rosbridge v2 protocol).",
        epilog="Settings are environment variables: LASERBOT_BIND, LASERBOT_ROSBRIDGE_PORT, LASERBOT_OPERATOR_TOKEN, "
        "LASERBOT_OPERATOR_TOKEN_FILE, LASERBOT_LOG_LEVEL, ROS_MASTER_URI.",
    ).parse_args()
    try:
        settings = Settings.from_env(os.environ)
    except SettingsError as error:
        print(error, file=sys.stderr)
        return 2
    configure_logging(settings.log_level)
    sys.setswitchinterval(SWITCH_INTERVAL)
    try:
        listener = bind(settings.bind, settings.port)
    except OSError as error:
        _log.error(
            "cannot listen at %s port %d: %s; end the program that uses it, "
            "or set LASERBOT_BIND, LASERBOT_ROSBRIDGE_PORT",
            settings.bind,
            settings.port,
            error.strerror or error,
        )
        return 1
    with listener:
        return Program(settings, listener).run()


def bind(address: str, port: int) -> socket.socket:
    """A TCP socket that has the port but does not listen yet. OSError when the port or address cannot be had."""
    family, kind, protocol, _, where = socket.getaddrinfo(address, port, type=socket.SOCK_STREAM)[0]
    bound = socket.socket(family, kind, protocol)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        bound.bind(where)
    except OSError:
        bound.close()
        raise
    return bound


class Program:
    """The running program. A signal ends it with 0, the loss of the ROS master with 1."""

    def __init__(self, settings: Settings, listener: socket.socket) -> None:
        self._settings, self._listener = settings, listener
        self._ending = threading.Event()
        self._exit_code = 0

    def run(self) -> int:
        """Serve until the end; returns the exit code."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: self._ending.set())
        uri = self._settings.master_uri
        if not wait_for_master(uri, NODE, self._ending):
            return 0
        watch = MasterWatch(uri, NODE, self._lost)
        try:
            watch.start()
            guard_handshakes()
            rospy.init_node(NODE, disable_signals=True, disable_rosout=True)
            configure_logging(self._settings.log_level)
            rospy.on_shutdown(lambda: self._lost("ROS has shut this node down"))
            asyncio.run(self._serve())
        except (OSError, rospy.ROSException) as error:
            self._lost(str(error))
        self._hurry()
        watch.stop()
        self._ending.set()
        rospy.signal_shutdown("rosbridge ends")
        return self._exit_code

    def _hurry(self) -> None:
        """rospy takes its leave of the master without any time-out: a master that hangs must not hold us."""
        timer = threading.Timer(END_WITHIN, os._exit, [self._exit_code])
        timer.daemon = True
        timer.start()

    def _lost(self, reason: str) -> None:
        """Fail, so that the supervisor starts the program again. From any thread."""
        if not self._ending.is_set():
            _log.error("%s: ending, to be started again", reason)
            self._exit_code = 1
            self._ending.set()

    async def _serve(self) -> None:
        bridge = Bridge(NODE, self._settings.operator_token)
        async with WebSocketServer(bridge, self._listener):
            _log.info("listening at %s port %d", self._settings.bind, self._settings.port)
            await asyncio.to_thread(self._ending.wait)
            bridge.stop()
            await asyncio.sleep(FLUSH)


if __name__ == "__main__":
    sys.exit(main())
