"""The cameras' relay: from the robots' cameras to the browsers (docs/protocol-camera.md)."""
