"""Logging of all programs: one line per event on stderr."""

import logging
import sys


def configure_logging(level: str) -> None:
    """Send everything of `level` ("debug" ... "error") and above to stderr.

    Call it again after `rospy.init_node`, which puts handlers of its own in place (a file, and a second stream).
    """
    handler = logging.StreamHandler(sys.stderr)
    handler.addFilter(_name_program)
    handler.addFilter(_shorten_ros)
    logging.basicConfig(
        level=level.upper(),
        format="%(asctime)s %(levelname)s %(name)s: %(message)s",
        handlers=[handler],
        force=True,
    )
    logging.getLogger("rosout").handlers.clear()
    for noisy in ("rospy", "rosgraph", "rosout", "waitress.queue"):
        logging.getLogger(noisy).setLevel(logging.WARNING)


def _name_program(record: logging.LogRecord) -> bool:
    """A line of the program's own module shows the program's name: the programs of a robot share one stderr."""
    spec = sys.modules["__main__"].__spec__
    if record.name == "__main__" and spec:
        record.name = spec.name.removesuffix(".__main__")
    return True


def _shorten_ros(record: logging.LogRecord) -> bool:
    """rospy logs the whole traceback of a lost connection, which is common here: keep its first and last line."""
    if record.name.startswith("ros"):
        lines = record.getMessage().splitlines()
        if len(lines) > 1:
            record.msg = f"{lines[0].removesuffix('Traceback (most recent call last):')} {lines[-1]}"
            record.args = ()
    return True
