"""A ROS 1 node on the running asyncio event loop, without rospy (wiki.ros.org: ROS/TCPROS, ROS/Slave_API)."""
