"""One address for all of the game: nginx before the web server, rosbridge, the cameras and the arena."""
