"""Which requests the game answers itself, and what each of them waits for."""

from functools import cached_property

from flask import Flask

from server.web.lanes import Lane

_DESK = "/operator"
_LISTS = {"/watch.json"}
_ROBOTS = {"/incAlive", "/restarting"}
_LOOKING = {"GET", "HEAD", "OPTIONS"}


class OwnRoutes:
    """Of the game's own application, once it has all its routes."""

    def __init__(self, app: Flask) -> None:
        self._app = app

    def has(self, path: str) -> bool:
        return path in self._paths or _is_desk(path)

    def lane(self, method: str, path: str) -> Lane:
        if path in _ROBOTS:
            return Lane.ROBOTS
        if not self.has(path):
            return Lane.PAGES
        if method in _LOOKING and (_is_desk(path) or path in _LISTS):
            return Lane.LISTS
        return Lane.PLAYERS

    @cached_property
    def _paths(self) -> frozenset[str]:
        return frozenset(rule.rule for rule in self._app.url_map.iter_rules())


def _is_desk(path: str) -> bool:
    return path == _DESK or path.startswith(_DESK + "/")
