"""Logging of all programs: one line per event on stderr, whatever strangers send and however often."""

import codecs
import json
import logging
import sys
import time
from collections import Counter
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from laser_bot_battle.settings import read_or_exit
from laser_bot_battle.token_bucket import TokenBuckets
from laser_bot_battle.variables import LOG_FORMAT

codecs.lookup("unicode_escape")  # its first use loads it, and what is logged may be that no file can be opened

MAX_LINE = 4000  # characters of a message
# the loggers that speak of what strangers and sketches send, and how many lines each has
_STRANGERS = (
    "server.web.",
    "waitress.",
    "asyncio.",  # out of descriptors, it says so 128 times a second, each time with a traceback
    "rospy.",
    "rosgraph.",
    "rosmaster.",
    "rosout.",
    "xmlrpc.",
    "robot.serial.device_services.",
    "robot.serial.device_topics.",
    "robot.serial.line.",
    "robot.serial.parameters.",
)
BURST = 20
PERIOD = 1.0  # s for each further line


def configure_logging(level: str, **fields: object) -> None:
    """Send everything of `level` ("debug" ... "error") and above to stderr, as LASERBOT_LOG_FORMAT says: a wrong format
    ends the program with exit code 2. Lines for programs have `fields`, and an event's own (`extra={"fields": ...}`).

    Call it again after `rospy.init_node`, which puts handlers of its own in place (a file, and a second stream).
    """
    handler = logging.StreamHandler(sys.stderr)
    handler.addFilter(_name_program)
    handler.addFilter(_shorten_ros)
    handler.addFilter(_Budget())
    is_json = read_or_exit("log", LOG_FORMAT.read) == "json"
    handler.setFormatter(_Json(fields) if is_json else _Visible("%(asctime)s %(levelname)s %(name)s: %(message)s"))
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
    logging.getLogger("rosout").handlers.clear()
    for noisy in ("rospy", "rosgraph", "rosmaster", "rosout", "xmlrpc", "waitress.queue"):
        logging.getLogger(noisy).setLevel(logging.WARNING)


def visible(text: str) -> str:
    """`text` with its control characters, line ends among them, as escapes, and not longer than `MAX_LINE`."""
    shown = "".join(char if char.isprintable() else _escaped(char) for char in text[: MAX_LINE + 1])
    return shown if len(shown) <= MAX_LINE else f"{shown[:MAX_LINE]}..."


def _escaped(char: str) -> str:
    return char.encode("unicode_escape").decode("ascii")


class _Visible(logging.Formatter):
    """What is logged may come from strangers: it never ends its line, and never begins one."""

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 - logging's name
        record.message = visible(record.message)
        return super().formatMessage(record)

    def formatException(self, ei: Any) -> str:  # noqa: N802 - logging's name
        return "\n".join(f"  {visible(line)}" for line in super().formatException(ei).splitlines())


class _Json(logging.Formatter):
    """One JSON object a line."""

    def __init__(self, fields: Mapping[str, object]) -> None:
        super().__init__()
        self._fields = fields

    def format(self, record: logging.LogRecord) -> str:
        line = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": visible(record.getMessage()),
            **self._fields,
            **getattr(record, "fields", {}),
        }
        if record.exc_info:
            line["traceback"] = self.formatException(record.exc_info)
        return json.dumps(line)


class _Budget(logging.Filter):
    """Strangers can make a logger speak as often as they like: what is too much is counted instead."""

    def __init__(self) -> None:
        super().__init__()
        self._lines = TokenBuckets(BURST, PERIOD)
        self._unsaid: Counter[str] = Counter()

    def filter(self, record: logging.LogRecord) -> bool:
        logger = record.name
        if not f"{logger}.".startswith(_STRANGERS):
            return True
        if self._lines.take(logger, time.monotonic()):
            self._unsaid[logger] += 1
            return False
        unsaid = self._unsaid.pop(logger, 0)
        if unsaid:
            record.msg, record.args = f"{record.getMessage()} (and {unsaid:,} more like this)", ()
            record.exc_info = None  # those before have told it
        return True


def _name_program(record: logging.LogRecord) -> bool:
    """A line of the program's own module shows the program's name: the programs of a robot share one stderr."""
    spec = sys.modules["__main__"].__spec__
    if record.name == "__main__" and spec:
        record.name = spec.name.removesuffix(".__main__")
    return True


def _shorten_ros(record: logging.LogRecord) -> bool:
    """rospy logs the whole traceback of a lost connection, which is common here: keep its first and last line."""
    if record.name.startswith(("ros", "xmlrpc")):
        lines = record.getMessage().splitlines()
        if len(lines) > 1:
            record.msg = f"{lines[0].removesuffix('Traceback (most recent call last):')} {lines[-1]}"
            record.args = ()
    return True
