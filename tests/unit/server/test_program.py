"""The life of a program of the master."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.polling import LATEST
from tests.support.ports import free_port

PROGRAM = """
import os, signal, sys, threading
from server.program.program import Program, ProgramSettings

class Unlucky(threading.Event):
    def wait(self, timeout=None):
        if threading.current_thread() is threading.main_thread():
            MOMENT
            timeout = None
        return super().wait(timeout)

settings = ProgramSettings("127.0.0.1", int(sys.argv[1]), "LASERBOT_WEB_PORT", "http://127.0.0.1:1", None, "info")
program = Program("/a", settings)
program.ending = Unlucky()
sys.exit(program.run(lambda listener: None))
"""


HOLDING = """with self._cond:
                signal.raise_signal(signal.SIGTERM)"""
# another thread gets it, and the wait of the main thread is not interrupted
DEAF = """signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})
            threading.Timer(0.3, os.kill, [os.getpid(), signal.SIGTERM]).start()"""


LEAVING = """program.begin_anew("a test")
            signal.raise_signal(signal.SIGTERM)"""


def run(program: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-c", program, str(free_port())]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(command, check=False, timeout=LATEST, capture_output=True, text=True, env=env)


@pytest.mark.parametrize("moment", [HOLDING, DEAF, LEAVING], ids=["holding the lock", "deaf", "beginning anew"])
def test_a_signal_at_any_moment_ends_it(moment: str) -> None:
    """Also at the worst: while the main thread holds the lock of what the signal is to set, or hears nothing, or while
    the program is about to begin anew."""
    done = run(PROGRAM.replace("MOMENT", moment))
    assert done.returncode == 0, done.stderr


def test_it_begins_anew_as_the_first_time(tmp_path: Path) -> None:
    """The same process, with the environment as it was."""
    seen = tmp_path / "seen"
    moment = f"""with open({str(seen)!r}, "a+") as file:
                print(os.getpid(), os.environ.get("ROS_IP"), file=file)
                file.seek(0)
                times = len(file.readlines())
            os.environ["ROS_IP"] = "127.0.0.1"
            program.begin_anew("a test") if times < 3 else program.fail("a test")"""
    assert run(PROGRAM.replace("MOMENT", moment)).returncode == 1
    (line,) = set(seen.read_text().splitlines())
    assert line.endswith(" None")
