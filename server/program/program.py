"""The life of a program of the master: address, ROS master, node, work, end."""

import argparse
import contextlib
import logging
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Self

from laser_bot_battle import listening, variables
from laser_bot_battle.addresses import check_interface
from laser_bot_battle.listening import Listener
from laser_bot_battle.master import Master, MasterWatch
from laser_bot_battle.settings import Variable, describe
from server.program.ros_address import settle

_log = logging.getLogger(__name__)

_END_WITHIN = 1.8  # s
_SIGNALS = {signal.SIGINT, signal.SIGTERM}
_NO_MORE = b"\0"


def read_arguments(
    program: str, description: str, *variables: Variable[Any], options: Mapping[str, Variable[Any]] | None = None
) -> dict[str, str]:
    """The environment, with what the command line says instead. `options` are the variables that can be given there,
    by their option's name. Besides there is only `--help`; what roslaunch adds for ROS is passed over."""
    parser = argparse.ArgumentParser(
        prog=program,
        description=description,
        epilog=describe(*variables),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    for option, variable in (options or {}).items():
        text = f"{variable.name} (see below)"
        if variable.is_flag:
            parser.add_argument(option, dest=variable.name, action="store_const", const="1", help=text)
        else:
            parser.add_argument(option, dest=variable.name, metavar="VALUE", help=text)
    given = parser.parse_args([argument for argument in sys.argv[1:] if ":=" not in argument])
    return {**os.environ, **{name: value for name, value in vars(given).items() if value is not None}}


@dataclass(frozen=True)
class ProgramSettings:
    """What every program of the master needs to live."""

    bind: str
    port: int  # 0: it listens on none
    port_variable: str  # by which the port can be changed
    master_uri: str
    metrics: tuple[str, int] | None  # where the first program is watched
    log_level: str

    @classmethod
    def from_env(cls, environ: Mapping[str, str], port: Variable[int] | None = None) -> Self:
        """Read `environ`; `port` is the variable of the program's port, if it has one. SettingsError for an impossible
        value."""
        check_interface(environ)
        return cls(
            bind=variables.BIND.read(environ),
            port=port.read(environ) if port else 0,
            port_variable=port.name if port else "",
            master_uri=variables.ROS_MASTER_URI.read(environ),
            metrics=variables.METRICS.read(environ),
            log_level=variables.LOG_LEVEL.read(environ),
        )


class Program:
    """The ROS node `name` while its program runs. A signal ends it with exit code 0, and `fail` with 1; after
    `begin_anew` another one runs in the same process."""

    def __init__(self, name: str, settings: ProgramSettings) -> None:
        self.name = name
        self.settings = settings
        self._environment = dict(os.environ)
        self._exit_code = 0
        self._begins_anew = self._is_told_to_end = False
        self.ending = threading.Event()

    def run(self, serve: Callable[[Listener], AbstractContextManager[None]]) -> int:
        """Do the work `serve` until the end; returns the exit code. For the main thread.

        The work gets sockets that have the port but do not listen yet: until all is ready, connections are refused.
        """
        return self._obeying(lambda: self._live_with_port(serve))

    def run_without_port(self, work: Callable[[], AbstractContextManager[None]]) -> int:
        """The same for a program that nobody but ROS connects to."""
        return self._obeying(lambda: self._live(work))

    def fail(self, reason: str) -> None:
        """End the program with 1, so that its supervisor, if it has one, starts it again. From any thread."""
        if not self.ending.is_set():
            _log.error("%s: the program ends, for its supervisor to start it again", reason)
            self._exit_code = 1
            self.ending.set()

    def begin_anew(self, reason: str) -> None:
        """End the program, and start it again in this process: the world has changed, and the program is not at fault,
        so its supervisor need not count a failure and wait. From any thread."""
        if not self.ending.is_set():
            _log.warning("%s: the program begins anew", reason)
            self._begins_anew = True
            self.ending.set()

    def start_thread(self, name: str, work: Callable[[], object]) -> threading.Thread:
        """A thread without which the program cannot go on."""

        def run() -> None:
            try:
                work()
            except Exception:
                _log.exception("%s failed", name)
            self.fail(f"{name} has ended")

        thread = threading.Thread(target=run, name=name, daemon=True)
        thread.start()
        return thread

    def _obeying(self, live: Callable[[], None]) -> int:
        """Live, and end when a signal says so; returns the exit code."""
        # Python calls a handler in this thread only, and not at all if the signal comes just before the thread begins
        # to wait; but it writes the signal's number into a socket at once.
        signals, written = socket.socketpair()
        self._signals = signals
        written.setblocking(False)
        signal.set_wakeup_fd(written.fileno())
        for number in _SIGNALS:
            signal.signal(number, lambda *_: None)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)
        obeying = threading.Thread(target=self._obey, args=[signals, written], name="signals", daemon=True)
        obeying.start()
        threading.Thread(target=self._end_in_time, name="end in time", daemon=True).start()
        live()
        # a signal from here on is for the next program in this process, whose mask is this one
        signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
        written.send(_NO_MORE)
        obeying.join()
        return self._leave()

    def _live_with_port(self, serve: Callable[[Listener], AbstractContextManager[None]]) -> None:
        bind, port = self.settings.bind, self.settings.port
        try:
            listener = listening.bind(bind, port)
        except OSError as error:
            _log.error(
                "cannot listen on %s port %d: %s; stop the program that uses it, or set LASERBOT_BIND or %s",
                bind,
                port,
                error.strerror or error,
                self.settings.port_variable,
            )
            self._exit_code = 1
            return
        with listener:
            self._live(lambda: serve(listener))

    def _live(self, work: Callable[[], AbstractContextManager[None]]) -> None:
        master = Master(self.settings.master_uri, self.name)
        if not master.wait(self.ending):
            return
        watch = MasterWatch(master, self.begin_anew, self.fail)
        try:
            watch.start()
            settle(self.settings.bind, self.settings.master_uri, self.ending, self.begin_anew)
            with work():
                self.ending.wait()
        except OSError as error:
            self.fail(str(error))
        self.ending.set()
        watch.stop()

    def _obey(self, signals: socket.socket, _written: socket.socket) -> None:
        while (number := signals.recv(1)) != _NO_MORE:
            if number[0] in _SIGNALS:
                self._is_told_to_end = True
                self.ending.set()

    def _end_in_time(self) -> None:
        """A master that hangs must not hold us when we are to end."""
        self.ending.wait()
        time.sleep(_END_WITHIN)
        os._exit(self._leave())

    def _leave(self) -> int:
        """The exit code, unless the program begins anew."""
        if self._begins_anew and not self._hears_signal():
            os.execve(sys.executable, sys.orig_argv, self._environment)
        return self._exit_code

    def _hears_signal(self) -> bool:
        """Also one that came after the last look, for any thread."""
        with contextlib.suppress(BlockingIOError):
            while number := self._signals.recv(1, socket.MSG_DONTWAIT):
                self._is_told_to_end |= number[0] in _SIGNALS
        return self._is_told_to_end
