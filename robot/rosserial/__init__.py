"""The host side of the rosserial protocol, pure: bytes and time in, events out. No port, no ROS, no threads."""
