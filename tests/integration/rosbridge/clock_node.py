"""A simulation's clock: says on /clock that it is 1000.25 s, again and again. Prints "ready"."""

import threading

import genpy
import rospy
from rosgraph_msgs.msg import Clock


def main() -> None:
    rospy.init_node("simulation")
    publisher = rospy.Publisher("/clock", Clock, queue_size=1)
    print("ready", flush=True)
    pause = threading.Event()  # rospy's own would wait for the simulation's time
    while not rospy.is_shutdown():
        publisher.publish(Clock(genpy.Time(1000, 250_000_000)))
        pause.wait(0.05)


if __name__ == "__main__":
    main()
