"""rospy in a program of the master."""

from collections.abc import Iterator
from contextlib import contextmanager

import rospy

from laser_bot_battle.log import configure_logging
from laser_bot_battle.rospy_cures import cure_rospy, cure_services
from server.program.program import Program


@contextmanager
def rospy_node(program: Program) -> Iterator[None]:
    """rospy's node while the program works. OSError when it cannot be started."""
    cure_rospy()
    try:
        rospy.init_node(program.name, disable_signals=True, disable_rosout=True)
    except rospy.ROSException as error:
        raise OSError(str(error)) from error
    cure_services()
    configure_logging(program.settings.log_level)
    rospy.on_shutdown(lambda: program.fail("ROS has shut this node down"))
    try:
        yield
    finally:
        program.ending.set()  # the shutdown is ours
        rospy.signal_shutdown("the program ends")
