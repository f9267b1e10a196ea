"""The tracker as its users find it: a process between a real ROS master and a camera."""

from tests.support.ros import ros_master

__all__ = ["ros_master"]
