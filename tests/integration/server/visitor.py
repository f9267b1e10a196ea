"""A visitor's browser at the proxy on this machine: `python3 -m tests.integration.server.visitor ORIGIN NAME`.

Prints as JSON what it has found there, with a form, a page and the two WebSockets of a page of ORIGIN; NAME is the
player's.
"""

import json
import socket
import sys
from typing import Any

import requests
from websockets.sync.client import ClientConnection
from websockets.typing import Origin, Subprotocol

from tests.support.polling import LATEST
from tests.support.sockets import connect

PROXY = "127.0.0.1"
NAME = "arena.example"
# what nobody may say of himself
FORGED = {"X-Forwarded-Host": "evil.example", "X-Forwarded-For": "9.9.9.9", "X-Forwarded-Proto": "https"}


def main() -> None:
    origin, name = sys.argv[1:]
    with requests.Session() as http:
        http.headers.update({"Host": NAME, **FORGED})
        form = http.post(
            f"http://{PROXY}/signUpUser", {"data": name, "wait": "1"}, headers={"Origin": origin}, timeout=LATEST
        )
        screen = http.get(f"http://{PROXY}/watch", timeout=LATEST).text
    found = {
        "form": form.status_code,
        "cookie": "laserbot_session" in form.cookies,
        "address": f">{NAME}</a>" in screen,
        "front": '<meta name="front"' in screen,
        "rosbridge": talk(origin, "/rosbridge", op="subscribe", topic="/game_status")["op"],
        "camera": talk(origin, "/camera", op="watch", robot=0).get("reason", ""),
    }
    print(json.dumps(found))


def talk(origin: str, path: str, **request: object) -> dict[str, Any]:
    """What is answered to the request; the sub-protocol that is offered is the one that is spoken."""
    with opened(origin, path) as talking:
        assert talking.subprotocol == "any", path
        talking.send(json.dumps(request))
        answer: dict[str, Any] = json.loads(talking.recv(10))
        return answer


def opened(origin: str, path: str) -> ClientConnection:
    return connect(
        f"ws://{NAME}{path}",
        sock=socket.create_connection((PROXY, 80), 5),
        origin=Origin(origin),
        subprotocols=[Subprotocol("any")],
        additional_headers=FORGED,
        proxy=None,
    )


if __name__ == "__main__":
    main()
