"""What runs below a program of a test."""

import contextlib

import psutil


def descendants(pid: int) -> list[psutil.Process]:
    """All processes below `pid`."""
    return psutil.Process(pid).children(recursive=True)


def command_line(process: psutil.Process) -> str:
    """The words of its command, empty when it has ended."""
    with contextlib.suppress(psutil.NoSuchProcess):  # a zombie is none, either
        return " ".join(process.cmdline())
    return ""
