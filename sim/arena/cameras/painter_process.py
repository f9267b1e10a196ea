"""The process that paints, seen from the arena: one picture at a time, and none that is late."""

import asyncio
import contextlib
import os
import sys
from collections.abc import AsyncIterator

from sim.arena.cameras.scene import LENGTH, MAX_FRAME, Scene, frame_of

START_SECONDS = 20.0  # until the first picture: NumPy is loaded and textures are painted, on a slow machine
PAINT_SECONDS = 3.0  # for each further picture; a process that takes longer is stuck
END_SECONDS = 1.0  # until it has ended


ENVIRONMENT = {
    "OPENBLAS_NUM_THREADS": "1",  # threads of NumPy's linear algebra would only cost memory
    # glibc would give each array back to the kernel at once, and get it again, page by page
    "MALLOC_MMAP_THRESHOLD_": str(2**26),
    "MALLOC_TRIM_THRESHOLD_": str(2**27),
}


class PainterError(Exception):
    """There are no pictures from this process any more; the text says why."""


class PainterProcess:
    """Asks the process for pictures. After a PainterError it gives none."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer
        self._patience = START_SECONDS

    async def paint(self, scene: Scene) -> bytes:
        """Its JPEG."""
        try:
            async with asyncio.timeout(self._patience):
                self._writer.write(frame_of(scene.encode()))
                (length,) = LENGTH.unpack(await self._reader.readexactly(LENGTH.size))
                if length > MAX_FRAME:
                    raise PainterError(f"it sends {length} bytes")
                jpeg = await self._reader.readexactly(length)
        except TimeoutError:
            raise PainterError(f"no picture came for {self._patience:g} s") from None
        except (OSError, EOFError):
            raise PainterError("it has ended") from None
        self._patience = PAINT_SECONDS
        return jpeg


@contextlib.asynccontextmanager
async def painter_process(module: str, room: bytes) -> AsyncIterator[PainterProcess]:
    """A new process of this module, which is gone afterwards. It gets `room` first."""
    try:
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-m", module,
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, env={**os.environ, **ENVIRONMENT},
        )  # fmt: skip
    except OSError as error:
        raise PainterError(f"it cannot be started: {error.strerror}") from None
    assert process.stdin and process.stdout
    try:
        process.stdin.write(frame_of(room))
        yield PainterProcess(process.stdout, process.stdin)
    finally:
        process.stdin.close()
        try:
            async with asyncio.timeout(END_SECONDS):
                await process.wait()
        except TimeoutError:
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            await process.wait()
        with contextlib.suppress(OSError):  # what it has not read; asyncio would write a traceback about that
            await process.stdin.wait_closed()
