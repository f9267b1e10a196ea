"""A program of the master whose work is done in an event loop of its own: rosbridge, and the cameras' relay."""

import asyncio
import logging
import sys
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from contextlib import asynccontextmanager, contextmanager

import uvloop

from laser_bot_battle import alive
from server.program.program import Program
from tcpros.node import Node

_log = logging.getLogger(__name__)


def warn_of_arguments(node: str) -> None:
    """Of ROS's arguments, but for what roslaunch adds when it knows the node by its own name."""
    for argument in sys.argv[1:]:
        if ":=" in argument and argument != f"__name:={node}" and not argument.startswith("__log:="):
            _log.warning("%s has no effect: nothing is remapped here, and settings are options (--help)", argument)


@contextmanager
def work_in_loop(program: Program, name: str, work: Callable[[], Coroutine[None, None, None]]) -> Iterator[None]:
    """`work` runs in a thread called `name` until it returns; the program ends with it."""

    def run() -> None:
        with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
            runner.run(work())

    thread = program.start_thread(name, run)
    try:
        yield
    finally:
        thread.join()


@asynccontextmanager
async def ros_node(program: Program, name: str) -> AsyncIterator[Node]:
    """The ROS node `name` of this program, while in the `with`."""
    started = Node(name, program.settings.master_uri)
    started.on_shutdown = lambda reason: program.fail(f"ROS has shut {name} down ({reason})")
    await started.start()
    try:
        yield started
    finally:
        await started.close()


async def live(program: Program) -> None:
    """Show that the loop turns, until the program is to end."""
    while not program.ending.is_set():
        alive.touch()
        await asyncio.to_thread(program.ending.wait, alive.PERIOD)
