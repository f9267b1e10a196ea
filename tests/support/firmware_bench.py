"""A robot on the test bench: the real firmware in the AVR simulator, its cable and its arena in a test's hands."""

import contextlib
import itertools
from collections.abc import Iterator
from pathlib import Path

from tests.support.avr import CYCLES_PER_SECOND, RESPONSE_ID, Arena, ArenaLink, AvrRobot, SerialHost, avr_robot
from tests.support.polling import until


class Bench:
    """A robot on the test bench: its serial cable and its arena in our hands."""

    def __init__(self, robot: AvrRobot, host: SerialHost, arena: ArenaLink) -> None:
        self.robot = robot
        self.host = host
        self.arena = arena

    def light_pulse(self, seconds: float) -> None:
        self.arena.send("light 1\n")
        self.robot.let_pass(seconds)
        self.arena.send("light 0\n")

    def stream(self, data: bytes, seconds: float) -> None:
        """Commands while the robot lives so long: on a busy machine it may live more slowly than we do."""
        end = self.robot.now + seconds * CYCLES_PER_SECOND

        def over() -> bool:
            self.host.stream(data, 0.05)
            return self.robot.now >= end

        until(over, seconds + 5)

    def was_driven(self, mark: int) -> bool:
        """Whether commands have come without a gap since the mark; else a busy machine has held us up."""
        commands = self.robot.cycles_of("uart-in", since=mark)
        return all(later - earlier < 0.25 * CYCLES_PER_SECOND for earlier, later in itertools.pairwise(commands))

    def last_command(self) -> int:
        """The cycle at which the last bytes from the host mark to arrive."""
        return self.robot.cycles_of("uart-in")[-1]

    def hits(self) -> int:
        return self.host.count(RESPONSE_ID)


@contextlib.contextmanager
def bench_in(folder: Path) -> Iterator[Bench]:
    arena = Arena()
    with (
        contextlib.closing(arena),
        avr_robot("--serial", folder / "tty", arena=arena.address) as robot,
        contextlib.closing(SerialHost(robot.uart)) as host,
    ):
        host.negotiate()
        yield Bench(robot, host, arena.accept())
