"""The WebSocket server that lets browsers take part in ROS: rosbridge v2 protocol, with a gate for players."""
