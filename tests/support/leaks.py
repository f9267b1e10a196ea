"""What a test can leave behind: threads, processes, listening ports, temporary files."""

import contextlib
import ctypes
import os
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

import psutil

from tests.support.polling import until

PR_SET_CHILD_SUBREAPER = 36

lasting: set[int] = set()  # processes that are started in a test, and serve further ones


def adopt_orphans() -> None:
    """What outlives its parent becomes a child of this process, so that it is seen."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)


@contextlib.contextmanager
def nothing_left(folder: Path, seconds: float = 2.0) -> Iterator[None]:
    """AssertionError that names what is there after the `with` and was not before, given time to end.

    Looks at this process and at the temporary files in `folder`.
    """
    before = present(folder)
    yield
    left: set[str] = set()

    def gone() -> bool:
        left.clear()
        left.update(present(folder) - before)
        return not left

    with contextlib.suppress(AssertionError):
        until(gone, seconds)
    assert not left, f"left behind: {', '.join(sorted(left))}"


def present(folder: Path) -> set[str]:
    # a loop's helper (asyncio_0) ends with the loop, such as Playwright's with the browser of a module
    threads = {f"thread {thread.name}" for thread in threading.enumerate() if not thread.name.startswith("asyncio_")}
    listening = {f"port {port}" for port in listening_ports()}
    # Chromium's own are gone with the browser of a module
    files = {f"file {path}" for path in folder.iterdir() if not path.name.startswith(".org.chromium.")}
    return threads | listening | children() | files


def listening_ports() -> set[int]:
    """The TCP ports on which this process listens. Asks its own descriptors: to read the kernel's table of all
    connections takes 10 ms."""
    ports = set()
    for link in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):  # one that has just been closed
            if not os.readlink(link).startswith("socket:"):
                continue
            with socket.socket(fileno=os.dup(int(link.name))) as one:
                is_tcp = one.family in (socket.AF_INET, socket.AF_INET6) and one.type == socket.SOCK_STREAM
                if is_tcp and one.getsockopt(socket.SOL_SOCKET, socket.SO_ACCEPTCONN):
                    ports.add(one.getsockname()[1])
    return ports


def children() -> set[str]:
    """The running processes below this one. The kernel's own list: psutil's asks every process of the machine."""
    found = set()
    for path in Path("/proc/self/task").glob("*/children"):
        pids = ""
        with contextlib.suppress(OSError):  # that thread has just ended
            pids = path.read_text()
        for pid in pids.split():
            with contextlib.suppress(psutil.Error):
                process = psutil.Process(int(pid))
                command = " ".join(process.cmdline())
                # ssh keeps a connection for the next play, and ends it; -W is what that goes through. multiprocessing
                # keeps its tracker for as long as this process lives.
                kept = "[mux]" in command or (command.startswith("ssh ") and " -W " in command)
                kept = kept or "multiprocessing.resource_tracker" in command
                if process.status() != psutil.STATUS_ZOMBIE and not kept and process.pid not in lasting:
                    found.add(f"process {pid}: {command}")
    return found
