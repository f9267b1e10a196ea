"""The ROS node of the Arduino: joins the topics of its sketch to ROS topics.

    python3 -m robot.serial_node /dev/ttyACM0 __name:=Robot0 command:=Robot0/command response:=Robot0/response
    python3 -m robot.serial_node _port:=/dev/ttyUSB0 _baud:=115200

    python3 -m robot.serial_node tcp

The second line is how rosserial_python's node is started; as there, `~port` and `~baud` may also be parameters of the
ROS master. Without any port, the Arduino is looked for as LASERBOT_SERIAL says. With `tcp`, a board connects to the
port `~tcp_port` (11411) instead; when it has gone, the node starts anew and waits for the next one.

Ends with exit code 0 on SIGINT or SIGTERM, and with 1 and the reason in the log when the device, the node's name or the
ROS master is lost: whoever started it starts it again.
"""

import argparse
import contextlib
import functools
import logging
import os
import select
import signal
import sys
import threading
from collections.abc import Callable
from typing import NoReturn

from robot.installed import missing_explained

with missing_explained():
    from laser_bot_battle import priority  # isort: split

    import rosgraph.names
    import rospy

    from laser_bot_battle import variables
    from laser_bot_battle.announcement import NoArenaError
    from laser_bot_battle.log import configure_logging
    from laser_bot_battle.master import Master, MasterWatch
    from laser_bot_battle.names import ROSSERIAL_PORT
    from laser_bot_battle.ros_environment import ros_environment
    from laser_bot_battle.rospy_cures import cure_rospy, cure_services
    from laser_bot_battle.settings import describe
    from robot.camera.address import tell_camera
    from robot.health import HealthThread
    from robot.master_location import locate_once
    from robot.pi_readings import PiReadings
    from robot.rosserial.host import ANSWER_TIMEOUT
    from robot.serial.connection import inherited, listen, listening_address
    from robot.serial.find_arduino import ArduinoLostError, find_arduino
    from robot.serial.line import SerialLine
    from robot.serial.port import BAUDRATE, NoAnswerError, PortError, SerialPort
    from robot.serial.private_parameters import BadParameterError, PrivateParameters
    from robot.serial.waker import Waker
    from robot.serial_process import NO_ANSWER
    from robot.settings import Settings

_log = logging.getLogger(__name__)

PROGRAM = "robot.serial_node"
NODE = "serial_node"  # without __name:=
TCP = "tcp"  # as rosserial_python calls it
STOPPED = "stopped"
LOST = "Connection to Arduino lost: %s"
END_WITHIN = 0.8  # s; whoever started it waits for 1 s


def main() -> int:
    parser = argparse.ArgumentParser(
        prog=PROGRAM,
        description=__doc__,
        epilog=describe(
            variables.ARENA_NAME,
            variables.MASTER,
            variables.ROS_MASTER_URI,
            variables.INTERFACE,
            variables.SERIAL,
            variables.PRIORITY,
            variables.CAMERA,
            variables.CAMERA_PORT,
            variables.CAMERA_URL,
            variables.LOG_LEVEL,
            variables.LOG_FORMAT,
        ),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "device", nargs="?", help="path of the serial device, a pyserial URL such as socket://host:port, or tcp"
    )
    parser.add_argument("tcp_port", nargs="?", type=int, help="where boards connect, if the device is tcp")
    parser.add_argument(
        "--end-with-stdin",
        action="store_true",
        help="end when stdin does: its writer is gone; and with code 3 if the device never answered",
    )
    parser.add_argument(
        "--answer-within",
        type=float,
        default=ANSWER_TIMEOUT,
        metavar="SECONDS",
        help="how long the device may take to answer (default %(default)g)",
    )
    arguments = parser.parse_args(rospy.myargv()[1:])
    environment = dict(os.environ)
    settings = Settings.load(PROGRAM)
    priority.take(settings.priority)  # of this thread, and of those that it starts
    try:
        uri = locate_once(settings).ros_master_uri
    except NoArenaError as error:
        _log.error("%s", error)
        return 1

    waker = Waker()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: waker.end(STOPPED, is_final=True))
    if arguments.end_with_stdin:
        threading.Thread(target=end_with_stdin, args=[waker], name="stdin", daemon=True).start()
    name = rosgraph.names.load_mappings(sys.argv).get("__name", NODE)
    master = Master(uri, name)
    watch = MasterWatch(master, waker.end)
    try:
        os.environ.update(ros_environment(os.environ, uri))
        watch.start()  # rospy would wait for an absent master for ever, and could not be stopped
        parameters = PrivateParameters(sys.argv, master)
        device, baudrate = arguments.device or parameters.text("port"), parameters.whole("baud", BAUDRATE)
        if device == TCP:
            device = f"tcp-listen://:{arguments.tcp_port or parameters.whole('tcp_port', ROSSERIAL_PORT)}"
    except OSError as error:
        _log.error("ROS master %s does not answer: %s", uri, error)
        return 1
    except BadParameterError as error:
        _log.error("%s", error)
        return 1
    try:
        tell_camera(settings, master)
        device = device or find_arduino(settings.devices)
        if (address := listening_address([device])) and not (device := next_board(*address, waker)):
            return 0 if waker.ended == STOPPED else 1
        with SerialPort(device, baudrate) as port:
            # rospy can be a node only once in a process
            anew = functools.partial(os.execve, sys.executable, sys.orig_argv, environment)
            return serve(port, waker, master, settings.log_level, arguments, begin_anew=anew)
    except (ArduinoLostError, PortError) as error:
        _log.error(LOST if isinstance(error, PortError) else "%s", error)
        return 1
    finally:
        watch.stop()


def next_board(host: str, port: int, waker: Waker) -> str:
    """The connection of the next board that comes, empty if the node is to end before; PortError if none can come."""
    try:
        with listen(host, port) as listener:
            _log.info("waiting for a board on port %d", port)
            while True:
                select.select([listener.fileno(), waker.fileno()], [], [])
                if waker.ended is not None:
                    return ""
                with contextlib.suppress(BlockingIOError, ConnectionError):
                    peer, _ = listener.accept()
                    try:
                        device = inherited(peer)
                    except OSError:  # it has left
                        peer.close()
                        continue
                    peer.detach()
                    return device
    except OSError as error:
        raise PortError(f"cannot listen for boards on port {port}: {error.strerror}") from None


def serve(
    port: SerialPort,
    waker: Waker,
    master: Master,
    log_level: str,
    arguments: argparse.Namespace,
    *,
    begin_anew: Callable[[], NoReturn],
) -> int:
    """Be the node until something ends it, and begin anew if it is to wait for the next board; else the exit code."""
    cure_rospy()
    rospy.init_node(NODE, disable_signals=True)
    cure_services()
    number = rospy.get_name().removeprefix("/Robot")
    configure_logging(log_level, **({"robot": int(number)} if number.isascii() and number.isdigit() else {}))
    rospy.on_shutdown(lambda: waker.end("another node has taken this node's name"))
    line = SerialLine(port, waker, master, arguments.answer_within)
    pi = PiReadings.none() if port.is_connection else PiReadings()
    health = HealthThread(line.board, port.device, line.state, pi)
    health.start()
    _log.info("%s serves %s", rospy.get_name(), port.device)
    code, again = 1, False

    def leave() -> None:
        if again and not waker.is_final:
            begin_anew()
        os._exit(code)

    try:
        reason = line.run()
        _log.info("%s ends: %s", rospy.get_name(), reason)
        code = 0 if reason == STOPPED else 1
    except PortError as error:
        _log.error(LOST, error)
        code = NO_ANSWER if arguments.end_with_stdin and isinstance(error, NoAnswerError) else 1
        again = port.is_connection and not arguments.end_with_stdin
    finally:
        health.stop()
        # rospy tells the ROS master, for whose answer it would wait for ever
        in_time = threading.Timer(END_WITHIN, leave)
        in_time.daemon = True
        in_time.start()
        rospy.signal_shutdown("serial node ends")
    if again:
        leave()
    return code


def end_with_stdin(waker: Waker) -> None:
    """A supervisor that was killed can stop nobody, but the kernel closes its pipe to us."""
    while os.read(sys.stdin.fileno(), 4096):
        pass
    waker.end("the program that started this node is gone")


if __name__ == "__main__":
    sys.exit(main())
