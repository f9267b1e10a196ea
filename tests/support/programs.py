"""Programs under test as child processes: started with their output captured, always ended."""

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path

from tests.support.polling import patience, until

ROOT = Path(__file__).resolve().parents[2]


class Program:
    """A child process in a process group of its own, its stdout and stderr kept in one file.

    It gets SIGINT if the tests end without ending it, such as by Ctrl-C.
    """

    def __init__(self, command: Sequence[str], env: Mapping[str, str] | None = None) -> None:
        self.command = [str(word) for word in command]
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the process
        weakref.finalize(self, self._log.close)
        environment = {**os.environ, "PYTHONUNBUFFERED": "1", **(env or {})}
        self.process = subprocess.Popen(
            ["setpriv", "--pdeathsig=INT", *self.command],
            env=environment,
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

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

    def stop(self, sig: int = signal.SIGINT, seconds: float = 10.0) -> int:
        """Signal the process, wait for its end, kill what is left of its group; returns its exit code."""
        if self.running:
            self.process.send_signal(sig)
        try:
            code = self.process.wait(seconds * patience())
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
            raise AssertionError(f"{self.command} did not end within {seconds} s:\n{self.output}") from None
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)
        return code

    def kill(self) -> None:
        """End the whole group at once, as a power cut does."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
