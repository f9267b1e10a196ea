"""A priority above all usual programs, for those between a player's key and a robot's wheels: what is late there is
late because it waits for a processor. It is taken where the system grants it (docs/lan.md says how), and not needed."""

import contextlib
import logging
import os
import resource
import signal
import threading

# Where NumPy is installed genpy imports it, and its OpenBLAS would start threads: with them there is no real-time
# priority. So import this module before genpy.
os.environ["OPENBLAS_NUM_THREADS"] = "1"

NICE = -10
LONGEST_TURN = 0.5  # s of work without a pause, after which a program has its usual priority again

_log = logging.getLogger(__name__)


def take(realtime: int) -> None:
    """Raise this thread's priority, and that of all threads that it will start; call it in the main thread, before it
    starts others. `realtime`: 1 to 99, or 0 for none. Programs that it starts would have that priority too."""
    if not realtime:
        return
    if len(os.listdir("/proc/self/task")) > 1:
        # they do not block the signal by which it is given back, and would be ended by it, with the whole program
        _log.warning("libraries have started threads: goes on at the usual priority")
        return
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(realtime))
        _give_back_when_busy()
        _log.info("runs at real-time priority %d", realtime)
        return
    with contextlib.suppress(OSError):
        os.setpriority(os.PRIO_PROCESS, 0, NICE)
        _log.info("runs at nice %d", NICE)


def keep_to_oneself() -> None:
    """What this thread starts has the usual priority. The thread keeps its own: others wait for what it holds."""
    with contextlib.suppress(OSError):
        policy = os.sched_getscheduler(0)
        os.sched_setscheduler(0, policy | os.SCHED_RESET_ON_FORK, os.sched_getparam(0))


def _give_back_when_busy() -> None:
    """A program that never pauses would leave the others nothing of a processor: strangers may keep one busy."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGXCPU})
    hard = resource.getrlimit(resource.RLIMIT_RTTIME)[1]
    turn = int(LONGEST_TURN * 1e6)
    resource.setrlimit(resource.RLIMIT_RTTIME, (turn if hard == resource.RLIM_INFINITY else min(turn, hard), hard))
    threading.Thread(target=_give_back, name="priority", daemon=True).start()


def _give_back() -> None:
    signal.sigwait({signal.SIGXCPU})
    for thread in os.listdir("/proc/self/task"):
        with contextlib.suppress(OSError):  # it has ended
            os.sched_setscheduler(int(thread), os.SCHED_OTHER, os.sched_param(0))
    _log.warning("has worked for %g s without a pause: goes on at the usual priority", LONGEST_TURN)
