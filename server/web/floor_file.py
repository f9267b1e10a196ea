"""The file that describes the floor, as operators change it: docs/floor.md."""

import contextlib
import hashlib
import json
import os
import tempfile
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from laser_bot_battle.floor import NAMES, floor_file, parse_floor, read_bytes

LISTS = ("walls", "starts", "zones")


class OtherVersionError(Exception):
    """Somebody has changed the file since."""


class Description(NamedTuple):
    """What the file says."""

    fields: dict[str, Any]
    version: str  # another one after each change


class FloorFile:
    """Of the floor with that name, which comes along and stays as it is, or at that path. Thread-safe."""

    def __init__(self, name_or_path: str) -> None:
        self.path = floor_file(name_or_path).resolve()
        self.name = name_or_path.lower() if name_or_path.lower() in NAMES else ""
        self._lock = threading.Lock()

    @property
    def is_writable(self) -> bool:
        return not self.name and os.access(self.path, os.W_OK) and os.access(self.path.parent, os.W_OK)

    def read(self) -> Description:
        """OSError if it cannot be read, ValueError if it describes no floor."""
        data = read_bytes(self.path)
        parse_floor(data)
        return Description(json.loads(data), _version(data))

    def write(self, fields: Mapping[str, Any], version: str, allow: Callable[[], None]) -> str:
        """Keep a floor that parse_floor() takes in place of `version`, all of it or nothing; returns its own version.

        `allow` is called when nothing else can go wrong, and may still raise. OtherVersionError if there is another
        one; OSError if it cannot be written.
        """
        data = to_text(fields).encode()
        with self._lock:
            if _version(read_bytes(self.path)) != version:
                raise OtherVersionError
            with tempfile.NamedTemporaryFile(dir=self.path.parent, prefix=f".{self.path.name}.", delete=False) as new:
                try:
                    new.write(data)
                    new.flush()
                    os.fchmod(new.fileno(), self.path.stat().st_mode)
                    os.fsync(new.fileno())
                    allow()
                    os.replace(new.name, self.path)
                except BaseException:
                    with contextlib.suppress(FileNotFoundError):
                        Path(new.name).unlink()
                    raise
        return _version(data)


def to_text(fields: Mapping[str, Any]) -> str:
    """The file of a floor, as people like to read it: a line for each of its things."""
    lines = [f"  {json.dumps(name)}: {json.dumps(fields[name])}" for name in ("width", "height")]
    for name in LISTS:
        things = ",\n".join(f"    {json.dumps(thing, ensure_ascii=False)}" for thing in fields.get(name, []))
        lines.append(f'  "{name}": [\n{things}\n  ]' if things else f'  "{name}": []')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _version(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
