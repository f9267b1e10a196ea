"""What master and robots share: names, settings, log format, calls to the ROS master; and the generated messages."""
