"""The requests of clients that are not in a registry that the tests use, as their sources write them."""

import json
from dataclasses import dataclass, field
from typing import Any

from websockets.sync.client import ClientConnection

from tests.support.polling import LATEST
from tests.support.sockets import connect

MOST = 2**31 - 1  # C#'s int.MaxValue, by which ros-sharp says that it wants no fragments
QUIET = {"compression": "none", "fragment_size": MOST}


@dataclass(frozen=True)
class Client:
    """What a client's requests have besides what they need."""

    name: str
    is_binary: bool = False
    ids: str = "{op}:{name}:{number}"  # empty: it gives none where it need not
    more: dict[str, dict[str, Any]] = field(default_factory=dict)


CLIENTS = (
    Client(
        "ros-sharp",
        is_binary=True,
        ids="{name}:{number}",
        more={
            "subscribe": {"throttle_rate": 0, "queue_length": 1, **QUIET},
            "call_service": QUIET,
            "advertise_service": {"id": None},
            "unadvertise_service": {"id": None},
        },
    ),
    Client(
        "jrosbridge",
        more={
            "subscribe": {"compression": "none", "throttle_rate": 0},
            "call_service": {"type": "std_srvs/SetBool"},
        },
    ),
    Client("roslibrust", ids=""),
)


class Speaker:
    """Says and hears as `client` does."""

    def __init__(self, client: Client, port: int) -> None:
        self._client, self._number = client, 0
        self.socket: ClientConnection = connect(f"ws://127.0.0.1:{port}")

    def say(self, op: str, **fields: Any) -> Any:
        """Returns the id."""
        self._number += 1
        if self._client.ids and "id" not in fields:
            name = fields.get("topic") or fields.get("service")
            fields["id"] = self._client.ids.format(op=op, name=name, number=self._number)
        fields.update(self._client.more.get(op, {}))
        text = json.dumps({"op": op, **fields})
        self.socket.send(text.encode() if self._client.is_binary else text)
        return fields.get("id")

    def hear(self, op: str) -> dict[str, Any]:
        """The next operation of that kind."""
        while (heard := json.loads(self.socket.recv(timeout=LATEST)))["op"] != op:
            assert heard["op"] != "status", heard
        return dict(heard)
