"""Journals of systemd's, as another host sends them to the master."""

import subprocess
import time
import uuid
from collections.abc import Iterable, Mapping
from pathlib import Path

REMOTE = "/usr/lib/systemd/systemd-journal-remote"
KERNEL = {"SYSLOG_IDENTIFIER": "kernel", "PRIORITY": "2", "MESSAGE": "Under-voltage detected!"}


def from_container(name: str, text: str) -> dict[str, str]:
    """What a container has said, as Docker's log driver writes it: all of stderr is an error."""
    return {"_SYSTEMD_UNIT": "docker.service", "CONTAINER_NAME": name, "PRIORITY": "3", "MESSAGE": text}


def write_journal(folder: Path, host: str, entries: Iterable[Mapping[str, str]], end: float | None = None) -> None:
    """Into that host's file, each entry 1 s after the one before; the last is of `end` (s since 1970; none: now)."""
    listed = list(entries)
    first = (time.time() if end is None else end) - len(listed)
    text = "".join(
        "\n".join(
            [
                f"__CURSOR=s={host};i={number}",
                f"__REALTIME_TIMESTAMP={round((first + number) * 1e6)}",
                f"__MONOTONIC_TIMESTAMP={number * 1_000_000}",
                f"_BOOT_ID={uuid.uuid5(uuid.NAMESPACE_DNS, host).hex}",
                f"_HOSTNAME={host}",
                *(f"{name}={value}" for name, value in entry.items()),
                "\n",
            ]
        )
        for number, entry in enumerate(listed, 1)
    )
    folder.mkdir(parents=True, exist_ok=True)
    command = [REMOTE, f"--output={folder / f'remote-{host}.journal'}", "-"]
    subprocess.run(command, input=text, text=True, check=True, capture_output=True)
