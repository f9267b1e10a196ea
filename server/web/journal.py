"""The newest lines of the fleet's logs: systemd's journals on the master, its own and those that robots send it."""

import json
import logging
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from systemd import journal

from laser_bot_battle.log import visible

_CONTAINERS = "docker.service"  # writes what its containers say
_CHATTER = ("sshd", "sudo")  # each login has its warnings
_WARNING = 4  # syslog's priorities: smaller is worse
_ERROR = 3
_LOOKED_AT = 1000  # entries for one question, which comes every 3 s: each keeps the web server busy for 17 us or more
_LEVELS = {"debug": "info", "info": "info", "warning": "warning", "error": "error", "critical": "error"}
# a line of ours, in the form that people read (laser_bot_battle.log)
_OURS = re.compile(r"\d{4}-\d\d-\d\d [\d:,]+ ([A-Z]+) (.*)", re.DOTALL)

_log = logging.getLogger(__name__)


class NothingToReadError(Exception):
    """There is no journal, or none that this program may read."""


class Line(NamedTuple):
    """What a program has said."""

    at: float  # s since 1970, by the clock of its host
    host: str
    program: str
    level: str  # info, warning, error
    text: str


class Journals:
    """Those below a folder, such as /var/log/journal. Any thread may ask: each question opens them anew.

    NothingToReadError for each question, as long as there is none.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def hosts(self) -> list[str]:
        """That have said anything, sorted."""
        with self._reader() as reader:
            return sorted(reader.query_unique("_HOSTNAME"))

    def newest(self, count: int, host: str = "", *, only_warnings: bool = False) -> list[Line]:
        """Up to so many lines of this host, or of all, the newest first."""
        lines = []
        for line in self._backwards(host):
            if not (only_warnings and line.level == "info"):
                lines.append(line)
                if len(lines) == count:
                    break
        return lines

    def _backwards(self, host: str) -> Iterator[Line]:
        with self._reader() as reader:
            of_host = {"_HOSTNAME": host} if host else {}
            reader.add_match(_SYSTEMD_UNIT=_CONTAINERS, **of_host)
            reader.add_disjunction()
            for priority in range(_WARNING + 1):  # of all other programs, what went wrong
                reader.add_match(PRIORITY=priority, **of_host)
            reader.seek_tail()
            for _ in range(_LOOKED_AT):
                entry = reader.get_previous()
                if not entry:
                    return
                line = _line(entry)
                if line is not None:
                    yield line

    def _reader(self) -> journal.Reader:
        # a folder's own reader would leave out those of other hosts; one that may not be read would fail for all
        files = [str(path) for path in self._folder.rglob("*.journal") if os.access(path, os.R_OK)]
        try:
            return self._open(files)
        except OSError:  # of one that is empty or torn, as after a cut of the power
            return self._open([file for file in files if _is_whole(file)])

    def _open(self, files: list[str]) -> journal.Reader:
        if not files:
            raise NothingToReadError(f"no journal in {self._folder} can be read")
        return journal.Reader(files=files)


def _is_whole(file: str) -> bool:
    try:
        journal.Reader(files=[file]).close()
    except OSError:
        return False
    return True


def _line(entry: dict[str, Any]) -> Line | None:
    """None for what tells an operator nothing."""
    text, priority = entry.get("MESSAGE", ""), entry.get("PRIORITY", _WARNING)
    if not isinstance(text, str):  # bytes that are no text
        text = repr(text)
    container = entry.get("CONTAINER_NAME")
    program = str(container or entry.get("SYSLOG_IDENTIFIER") or entry.get("_COMM", ""))
    if container:
        level, text = _ours(text)
    elif priority <= _WARNING and not program.startswith(_CHATTER):
        level = "error" if priority <= _ERROR else "warning"
    else:
        return None
    return Line(
        at=entry["__REALTIME_TIMESTAMP"].timestamp(),
        host=str(entry.get("_HOSTNAME", "")),
        program=program,
        level=level,
        text=visible(text),
    )


def _ours(text: str) -> tuple[str, str]:
    """Level and message of a container's line. The engine knows no level: to it, all is an error."""
    match = _OURS.match(text)
    if match:
        return _LEVELS.get(match[1].lower(), "info"), match[2]
    try:
        line = json.loads(text)
        return _LEVELS[line["level"]], f"{line['logger']}: {line['message']}"
    except (ValueError, TypeError, KeyError):
        return "info", text
