"""Where the robots are, by a camera above the floor (docs/overhead-camera.md)."""
