"""A process that paints pictures for the arena, which starts it: frames come by stdin, go by stdout."""

import os
import signal
import sys
from collections.abc import Callable

from sim.arena.cameras.scene import Scene, frame_of, read_frame

NICENESS = 5  # on a machine with too few cores, the robots' processors and light come first


def paint(painter: Callable[[bytes], Callable[[Scene], bytes]]) -> None:
    """Answer each scene with its JPEG until stdin ends, as it does with the arena however that ends. `painter` makes of
    the first frame what makes JPEGs."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; the arena ends this one
    os.nice(NICENESS)
    room = read_frame(sys.stdin.buffer)
    if room is None:
        return
    jpeg = painter(room)
    try:
        while (scene := read_frame(sys.stdin.buffer)) is not None:
            sys.stdout.buffer.write(frame_of(jpeg(Scene.decode(scene))))
            sys.stdout.buffer.flush()
    except BrokenPipeError:  # the arena has been killed; what Python still flushes at its end goes nowhere
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
