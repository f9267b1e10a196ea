"""The life of a program of the master."""

import os
import subprocess
import sys

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


@pytest.mark.parametrize("moment", [HOLDING, DEAF], ids=["holding the lock", "deaf"])
def test_a_signal_at_any_moment_ends_it(moment: str) -> None:
    """Also at the worst: while the main thread holds the lock of what the signal is to set, or hears nothing."""
    command = [sys.executable, "-c", PROGRAM.replace("MOMENT", moment), str(free_port())]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(command, check=False, timeout=LATEST, capture_output=True, text=True, env=env)
    assert done.returncode == 0, done.stderr
