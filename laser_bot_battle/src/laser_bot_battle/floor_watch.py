"""Notices that the floor's file describes another floor, as after somebody has saved one at the operator's desk."""

import asyncio
import contextlib

from laser_bot_battle.floor import Floor, floor_file, parse_floor, read_bytes

PERIOD = 1.0  # s


async def another_floor(name_or_path: str, floor: Floor) -> None:
    """Return when the file describes another one than `floor`. Without a file, and while it describes none, nothing has
    changed."""
    path, seen = floor_file(name_or_path), -1
    while True:
        with contextlib.suppress(OSError, ValueError):
            changed = path.stat().st_mtime_ns
            if changed != seen:
                seen = changed
                if parse_floor(read_bytes(path)) != floor:
                    return
        await asyncio.sleep(PERIOD)
