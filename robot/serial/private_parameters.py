"""A node's private parameters, which it needs before rospy reads them: `_port:=` on the command line, or `~port` of the
ROS master, where roslaunch puts them."""

from collections.abc import Sequence

from laser_bot_battle.master import Master, MasterError


class BadParameterError(ValueError):
    """A parameter has an impossible value; the text names it."""


class PrivateParameters:
    def __init__(self, argv: Sequence[str], master: Master) -> None:
        self._given = dict(word[1:].split(":=", 1) for word in argv if word[:1] == "_" != word[1:2] and ":=" in word)
        self._master = master

    def text(self, name: str) -> str:
        """Empty if it is not set; OSError if the ROS master does not answer."""
        if name in self._given:
            return self._given[name]
        try:
            return str(self._master.call("getParam", f"{self._master.node}/{name}"))
        except MasterError:
            return ""

    def whole(self, name: str, default: int) -> int:
        """A positive number; BadParameterError, and as above."""
        text = self.text(name)
        if not text:
            return default
        if not (text.isascii() and text.isdigit() and int(text) > 0):
            raise BadParameterError(f"~{name} is {text!r}: it must be a positive whole number")
        return int(text)
