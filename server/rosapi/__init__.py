"""rosapi: the ROS node that tells rosbridge's clients about topics, services, nodes, types and parameters."""
