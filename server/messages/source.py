"""Python source that is written for a message type.

Every type gets functions of its own, as genpy does it: that is several times faster than asking for every field of
every message what it is.
"""

from collections.abc import Mapping
from typing import Any


class Source:
    """A function in the making. `names`: what its source may use."""

    def __init__(self, signature: str, names: Mapping[str, Any]) -> None:
        self._lines = [f"def {signature}:"]
        self._names = dict(names)
        self._count = 0
        self.depth = 1

    def line(self, text: str) -> None:
        self._lines.append("    " * self.depth + text)

    def variable(self) -> str:
        """A new name."""
        self._count += 1
        return f"v{self._count}"

    def constant(self, value: Any) -> str:
        """The name by which the source has `value`."""
        name = self.variable()
        self._names[name] = value
        return name

    def function(self, name: str, title: str) -> Any:
        """The function `name`; `title` stands in tracebacks."""
        exec(compile("\n".join(self._lines), f"<{title}>", "exec"), self._names)
        return self._names[name]
