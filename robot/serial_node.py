"""The ROS node of the Arduino: joins the topics of its sketch to ROS topics.

    python3 -m robot.serial_node /dev/ttyACM0 __name:=Robot0 command:=Robot0/command response:=Robot0/response

Ends with exit code 0 on SIGINT or SIGTERM, and with 1 and the reason in the log when the device, the node's name or the
ROS master is lost: whoever started it starts it again.
"""

import argparse
import logging
import os
import signal
import sys
import threading

from robot.installed import missing_explained

with missing_explained():
    import rosgraph.names
    import rospy

    from laser_bot_battle import variables
    from laser_bot_battle.log import configure_logging
    from laser_bot_battle.master import Master, MasterWatch
    from laser_bot_battle.settings import describe
    from robot.mailbox import Mailbox
    from robot.ros_environment import ros_environment
    from robot.serial_line import SerialLine
    from robot.serial_port import PortError, SerialPort
    from robot.settings import Settings

_log = logging.getLogger(__name__)

PROGRAM = "robot.serial_node"
NODE = "serial_node"  # without __name:=
STOPPED = "stopped"


def main() -> int:
    parser = argparse.ArgumentParser(
        prog=PROGRAM,
        description=__doc__,
        epilog=describe(variables.MASTER, variables.ROS_MASTER_URI, variables.LOG_LEVEL),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("device", help="path of the serial device, or a pyserial URL such as socket://host:port")
    parser.add_argument("--end-with-stdin", action="store_true", help="end when stdin does: its writer is gone")
    arguments = parser.parse_args(rospy.myargv()[1:])
    settings = Settings.load(PROGRAM)

    mailbox = Mailbox()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: mailbox.end(STOPPED))
    if arguments.end_with_stdin:
        threading.Thread(target=end_with_stdin, args=[mailbox], name="stdin", daemon=True).start()
    name = rosgraph.names.load_mappings(sys.argv).get("__name", NODE)
    watch = MasterWatch(Master(settings.ros_master_uri, name), mailbox.end)
    try:
        os.environ.update(ros_environment(os.environ, settings.ros_master_uri))
        watch.start()  # rospy would wait for an absent master for ever, and could not be stopped
    except OSError as error:
        _log.error("ROS master %s does not answer: %s", settings.ros_master_uri, error)
        return 1
    try:
        with SerialPort(arguments.device) as port:
            return serve(port, mailbox, settings.log_level)
    except PortError as error:
        _log.error("Connection to Arduino lost: %s", error)
        return 1
    finally:
        watch.stop()


def serve(port: SerialPort, mailbox: Mailbox, log_level: str) -> int:
    """Be the node until something ends it; returns the exit code. PortError when the device is lost."""
    rospy.init_node(NODE, disable_signals=True)
    configure_logging(log_level)
    rospy.on_shutdown(lambda: mailbox.end("another node has taken this node's name"))
    line = SerialLine(port, mailbox)
    _log.info("%s serves %s", rospy.get_name(), port.device)
    try:
        reason = line.run()
        line.stop_device()
    finally:
        rospy.signal_shutdown("serial node ends")
    _log.info("%s ends: %s", rospy.get_name(), reason)
    return 0 if reason == STOPPED else 1


def end_with_stdin(mailbox: Mailbox) -> None:
    """A supervisor that was killed can stop nobody, but the kernel closes its pipe to us."""
    while os.read(sys.stdin.fileno(), 4096):
        pass
    mailbox.end("the program that started this node is gone")


if __name__ == "__main__":
    sys.exit(main())
