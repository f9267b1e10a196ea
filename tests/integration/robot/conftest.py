from tests.support.ros import ros_master

__all__ = ["ros_master"]
