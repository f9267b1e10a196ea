"""Boards without a Raspberry Pi, such as an ESP8266 or ESP32, connect by TCP as to upstream's rosserial_server. Each
connection is a robot of its own, for which the robot's main program runs until the connection ends."""

import asyncio
import contextlib
import itertools
import logging
import os
import socket
import sys
import time
from collections.abc import Iterator

from laser_bot_battle import alive, variables
from laser_bot_battle.child import stop, until_signalled
from laser_bot_battle.listening import Listener
from laser_bot_battle.token_bucket import TokenBuckets
from robot.keeper import Heart
from robot.serial.connection import inherited, listen

MAX_BOARDS = 32  # at once; each is three processes
MAX_OF_ONE_MACHINE = 8  # a router may hide several
BURST, PERIOD = 3, 5.0  # starts of a machine's robots at once, and s for each further one
STOP_TIMEOUT = 3.0  # s; the robot's program has to stop its own first
SUCCESSION = 3.0  # s that a board's last connection has to end: a board that was reset has not closed it
REFUSALS_TOLD = 10.0  # s between two

_log = logging.getLogger(__name__)


class BoardServer:
    """Serves one port until SIGINT or SIGTERM."""

    def __init__(self, program: str, heart: Heart) -> None:
        """`program`: the module that is a robot's main program."""
        self._program = program
        self._heart = heart
        self._boards: dict[asyncio.Task[None], str] = {}  # with their machines
        self._names: set[str] = set()
        self._starts = TokenBuckets(BURST, PERIOD)
        self._refusals = TokenBuckets(1, REFUSALS_TOLD)

    async def run(self, host: str, port: int) -> int:
        """Returns the exit code."""
        end = until_signalled()
        try:
            listener = listen(host, port)
        except OSError as error:
            _log.error("cannot listen for boards on port %d: %s", port, error.strerror)
            return 1
        with listener:
            _log.info("boards may connect to port %d", port)
            accepting = asyncio.create_task(self._accept(listener))
            try:
                while not end.is_set():
                    self._heart.beat()
                    alive.touch()
                    with contextlib.suppress(TimeoutError):
                        await asyncio.wait_for(end.wait(), alive.PERIOD)
            finally:
                self._heart.rest()
                for task in (accepting, *self._boards):
                    task.cancel()
                await asyncio.gather(accepting, *self._boards, return_exceptions=True)
        _log.info("ending")
        return 0

    async def _accept(self, listener: Listener) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                # mypy expects a socket, and it does all that is asked of one
                peer, (machine, *_) = await loop.sock_accept(listener)  # type: ignore[arg-type]
            except OSError as error:  # too many open files, or a peer that was quick to leave
                _log.warning("cannot take a connection: %s", error.strerror)
                await asyncio.sleep(1)
                continue
            if not self._has_room(machine):
                peer.close()
                continue
            task = asyncio.create_task(self._be_robot(peer, machine))
            self._boards[task] = machine
            task.add_done_callback(self._boards.pop)

    def _of(self, machine: str) -> set[asyncio.Task[None]]:
        return {task for task, other in self._boards.items() if other == machine}

    def _has_room(self, machine: str) -> bool:
        own = len(self._of(machine))
        if len(self._boards) < MAX_BOARDS and own < MAX_OF_ONE_MACHINE:
            return True
        if not self._refusals.take("", time.monotonic()):
            _log.warning(
                "refused a board at %s: %d boards are connected, %d from that address", machine, len(self._boards), own
            )
        return False

    async def _be_robot(self, peer: socket.socket, machine: str) -> None:
        """Until the connection ends."""
        with peer:
            others = self._of(machine) - {asyncio.current_task()}
            if others:
                await asyncio.wait(others, timeout=SUCCESSION, return_when=asyncio.FIRST_COMPLETED)
            while wait := self._starts.take(machine, time.monotonic()):
                await asyncio.sleep(wait)
            with self._name(machine) as name:
                try:
                    child = await self._start(inherited(peer), peer.fileno(), name)
                except OSError as error:  # the board has left meanwhile
                    _log.warning("cannot start a robot for %s: %s", name, error.strerror)
                    return
                peer.close()
                try:
                    await child.wait()
                finally:
                    await stop(child, STOP_TIMEOUT)
                _log.info("%s has gone", name)

    @contextlib.contextmanager
    def _name(self, machine: str) -> Iterator[str]:
        """By which the server knows the robot: the same when it returns."""
        names = (f"board-{machine}" + (f"-{number}" if number > 1 else "") for number in itertools.count(1))
        name = next(name for name in names if name not in self._names)
        self._names.add(name)
        try:
            yield name
        finally:
            self._names.remove(name)

    async def _start(self, device: str, file: int, name: str) -> asyncio.subprocess.Process:
        _log.info("%s: a board has connected, as the robot %s", device.partition("#")[0], name)
        own = {
            variables.SERIAL.name: device,
            variables.ROBOT_NAME.name: name,
            # what is on this machine is not on the robot
            variables.LED.name: "none",
            variables.CAMERA.name: "",
            variables.CAMERA_URL.name: "",
            variables.ALIVE_FILE.name: "",
        }
        return await asyncio.create_subprocess_exec(
            sys.executable, "-m", self._program, env={**os.environ, **own}, pass_fds=[file], process_group=0
        )
