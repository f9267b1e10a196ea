"""ROS messages: what they are made of, and their bytes. Types are found by server.messages.types."""
