"""Programs under test as child processes: started with their output captured, always ended."""

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import weakref
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from tests.support.polling import until
from tests.support.processes import descendants

ROOT = Path(__file__).resolve().parents[2]
TAIL = 25  # lines
ABORT = 2.0  # s for the last words of one that hangs

_all: "weakref.WeakSet[Program]" = weakref.WeakSet()


def last_words() -> Iterator[tuple[str, str]]:
    """The command and the end of the log of each program that a test has started, for whoever reads why it failed."""
    for program in sorted(_all, key=lambda program: program.process.pid):
        state = "still runs" if program.running else f"ended with {program.process.returncode}"
        lines = program.log.splitlines()
        yield f"{' '.join(program.command)} ({state})", "\n".join(lines[-TAIL:])


class Program:
    """A child process in a process group of its own, its stdout and stderr kept in one file.

    It gets SIGINT if the tests end without ending it, such as by Ctrl-C.
    """

    def __init__(self, command: Sequence[str], env: Mapping[str, str] | None = None) -> None:
        self.command = [str(word) for word in command]
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the process
        weakref.finalize(self, self._log.close)
        environment = {**os.environ, "PYTHONUNBUFFERED": "1", "PYTHONFAULTHANDLER": "1", **(env or {})}
        self.process = subprocess.Popen(
            ["setpriv", "--pdeathsig=INT", *self.command],
            env=environment,
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        _all.add(self)

    @classmethod
    def python(cls, module: str, *arguments: str, env: Mapping[str, str] | None = None) -> "Program":
        """The Python module `module` of this repository, by the interpreter that runs the tests."""
        env = {"PYTHONPATH": str(ROOT / "build" / "python"), **(env or {})}
        return cls([sys.executable, "-m", module, *arguments], env)

    @property
    def output(self) -> str:
        """All that the program has printed so far."""
        size = os.fstat(self._log.fileno()).st_size
        return os.pread(self._log.fileno(), size, 0).decode(errors="replace")

    @property
    def log(self) -> str:
        """What tells why something went wrong: all that it has printed, unless it writes its log elsewhere."""
        return self.output

    @property
    def running(self) -> bool:
        return self.process.poll() is None

    def wait_for(self, text: str, seconds: float = 30.0) -> str:
        """Wait until the output contains `text`; AssertionError with the output if it ends or is late."""

        def seen() -> bool:
            if text in self.output:
                return True
            assert self.running, f"{self.command} ended with {self.process.returncode}:\n{self.output}"
            return False

        try:
            until(seen, seconds, f"{text!r} from {self.command}")
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.output}") from None
        return self.output

    def exit_code(self, seconds: float = 20.0) -> int:
        """Wait for its own end; AssertionError with the output, and with where it hangs, if it is late."""
        try:
            until(lambda: not self.running, seconds, f"the end of {self.command}")
        except AssertionError as error:
            self._abort()
            raise AssertionError(f"{error}\n{self.output}") from None
        return self.process.returncode

    def stop(self, sig: int = signal.SIGINT, seconds: float = 10.0) -> int:
        """Signal the process, wait for its end, kill what is left of its group; returns its exit code."""
        if self.running:
            self.process.send_signal(sig)
        try:
            return self.exit_code(seconds)
        finally:
            self.kill()

    def _abort(self) -> None:
        """Have what hangs say where: Python's fault handler prints what each thread is at."""
        for pid in [*(process.pid for process in reversed(descendants(self.process.pid))), self.process.pid]:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGABRT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(ABORT)

    def kill(self) -> None:
        """End the whole group at once, as a power cut does."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
