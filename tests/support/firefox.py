"""Debian's Firefox, driven by its own protocol, WebDriver BiDi: Playwright can drive only a Firefox of its own."""

import base64
import json
import re
from pathlib import Path
from typing import Any, Self

from tests.support.polling import LATEST
from tests.support.programs import Program
from tests.support.sockets import connect

KEYS = {"Enter": "\ue007", "ArrowUp": "\ue013", "ArrowLeft": "\ue012"}  # as WebDriver names them
WIDTH, HEIGHT = 1280, 800


class Firefox:
    """One page without a window; `errors` are those that its scripts did not catch. Use it as a context manager."""

    def __init__(self, profile: Path) -> None:
        self.errors: list[str] = []
        self._calls = 0
        self._program = Program(
            ["firefox-esr", "--headless", "--no-remote", "--profile", str(profile), "--remote-debugging-port", "0"],
            {"HOME": str(profile), "TMPDIR": str(profile)},
        )
        try:
            self._program.wait_for("BiDi listening on ws", 60)
            (url,) = re.findall(r"BiDi listening on (ws:\S+)", self._program.output)
            self._socket = connect(f"{url}/session", max_size=None)
            self.call("session.new", capabilities={})
            self._tab = {"context": self.call("browsingContext.create", type="window")["context"]}
            self.call("session.subscribe", events=["log.entryAdded"])
            self.resize(WIDTH, HEIGHT)
        except BaseException:
            self._program.kill()
            raise

    def call(self, method: str, **parameters: object) -> dict[str, Any]:
        """Its result; AssertionError with Firefox's own words when it fails."""
        self._calls += 1
        self._socket.send(json.dumps({"id": self._calls, "method": method, "params": parameters}))
        while True:
            heard = json.loads(self._socket.recv(timeout=LATEST))
            if heard.get("method") == "log.entryAdded" and heard["params"]["type"] == "javascript":
                self.errors.append(heard["params"]["text"])
            if heard.get("id") == self._calls:
                assert heard["type"] == "success", heard
                return dict(heard["result"])

    def open(self, url: str) -> None:
        self.call("browsingContext.navigate", **self._tab, url=url, wait="complete")

    def resize(self, width: int, height: int) -> None:
        self.call("browsingContext.setViewport", **self._tab, viewport={"width": width, "height": height})

    def ask(self, expression: str) -> Any:
        """The value of JavaScript's `expression` in the page."""
        result = self.call(
            "script.evaluate", target=self._tab, expression=f"JSON.stringify({expression})", awaitPromise=True
        )
        assert result["type"] == "success", result["exceptionDetails"]["text"]
        return json.loads(result["result"].get("value", "null"))

    def type(self, text: str) -> None:
        self._keys([(kind, character) for character in text for kind in ("keyDown", "keyUp")])

    def down(self, key: str) -> None:
        self._keys([("keyDown", KEYS[key])])

    def up(self, key: str) -> None:
        self._keys([("keyUp", KEYS[key])])

    def press(self, key: str) -> None:
        self.down(key)
        self.up(key)

    def _keys(self, actions: list[tuple[str, str]]) -> None:
        keys = [{"type": kind, "value": value} for kind, value in actions]
        source = {"type": "key", "id": "keyboard", "actions": keys}
        self.call("input.performActions", **self._tab, actions=[source])

    def click(self, selector: str) -> None:
        x, y = self.ask(
            f"(({{left, top, width, height}}) => [Math.round(left + width / 2), Math.round(top + height / 2)])"
            f"(document.querySelector({json.dumps(selector)}).getBoundingClientRect())"
        )
        actions = [{"type": "pointerMove", "x": x, "y": y}]
        actions += [{"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]
        self.call("input.performActions", **self._tab, actions=[{"type": "pointer", "id": "mouse", "actions": actions}])

    def picture(self, **clip: int) -> bytes:
        """A PNG of what is to be seen, or of the part `x`, `y`, `width`, `height` of it."""
        part = {"clip": {"type": "box", **clip}} if clip else {}
        return base64.b64decode(self.call("browsingContext.captureScreenshot", **self._tab, **part)["data"])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()
        self._program.kill()
