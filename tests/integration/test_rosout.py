"""What nodes say on /rosout is on /rosout_agg, where ROS's tools read it."""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import psutil
import pytest
import rosgraph_msgs.msg

from laser_bot_battle.master import Master
from tests.support.polling import until
from tests.support.programs import Program
from tests.support.ros import RosMaster, own_master

__all__ = ["own_master"]

# rospy knows only one node per process
SAY = """
import sys, rospy
rospy.init_node("speaker", anonymous=True)
number = 0
while not rospy.is_shutdown():
    rospy.logwarn("grüß Gott %d", number)
    number += 1
    rospy.sleep(0.05)
"""
HEAR = """
import rospy
from rosgraph_msgs.msg import Log
rospy.init_node("hearer", anonymous=True, disable_rosout=True)
rospy.Subscriber("/rosout_agg", Log, lambda line: print(line.level, line.name, line.msg[:40], flush=True))
rospy.spin()
"""
# more than may wait for one who does not read
FLOOD = """
import rospy
from rosgraph_msgs.msg import Log
rospy.init_node("flood", disable_rosout=True)
publisher = rospy.Publisher("/rosout", Log, queue_size=None)
while not publisher.get_num_connections():
    rospy.sleep(0.01)
for number in range(60):
    publisher.publish(msg="much " * 200_000)
while not rospy.is_shutdown():
    publisher.publish(msg="the last one")
    rospy.sleep(0.05)
"""
WARNING = rosgraph_msgs.msg.Log.WARN

Start = Callable[..., Program]


@pytest.fixture
def start(own_master: RosMaster) -> Iterator[Start]:
    """Starts Python with these arguments in the ROS of the test, whose master runs."""
    own_master.start()
    with ExitStack() as ends:

        def begin(*arguments: str) -> Program:
            program = Program([sys.executable, *arguments], own_master.env)
            ends.callback(program.kill)
            return program

        yield begin


def test_log_lines_of_all_nodes_are_passed_on_as_they_are(start: Start) -> None:
    start("-m", "server.ros.rosout", "__name:=everybodys_log")
    hearer = start("-c", HEAR)
    start("-c", SAY)
    start("-c", SAY)

    def speakers() -> set[str]:
        lines = [line.split(" ", 2) for line in hearer.output.splitlines()]
        return {name for level, name, text in lines if (level, text[:9]) == (str(WARNING), "grüß Gott")}

    until(lambda: len(speakers()) == 2, 20, "both nodes are heard")


def test_after_a_restart_of_the_master_it_passes_them_on_again(start: Start, own_master: RosMaster) -> None:
    rosout, master = start("-m", "server.ros.rosout"), Master(own_master.uri, "test")
    until(lambda: ["/rosout", ["/rosout"]] in master.call("getSystemState")[1], 20, "it is registered")
    own_master.stop()
    own_master.start()
    rosout.wait_for("the program begins anew")
    hearer = start("-c", HEAR)
    start("-c", SAY)
    hearer.wait_for("grüß Gott")


def test_a_hearer_that_hangs_costs_no_memory_and_the_others_nothing(start: Start) -> None:
    rosout = psutil.Process(start("-m", "server.ros.rosout").process.pid)
    frozen, hearer = start("-c", HEAR), start("-c", HEAR)
    start("-c", SAY)
    for each in (frozen, hearer):
        each.wait_for("grüß Gott")
    before = rosout.memory_info().rss
    frozen.process.send_signal(signal.SIGSTOP)
    start("-c", FLOOD)
    hearer.wait_for("the last one")
    assert rosout.memory_info().rss < before + 30_000_000  # of 60,000,000 that were said
    frozen.process.send_signal(signal.SIGCONT)
