"""A message on its way from ROS to clients: encoded once in each form that somebody wants."""

from pickle import PickleBuffer
from typing import Any, NamedTuple

from server.messages.types import MessageType
from server.rosbridge.compression import raw
from server.rosbridge.outgoing import outgoing, takes_long
from server.websocket.frames import frame
from server.websocket.requests import dumps


class Form(NamedTuple):
    """How a subscriber wants messages."""

    topic: str  # by the name that the client uses
    compression: str = "none"
    fragment_size: int | None = None  # characters


class Delivery:
    """One serialized message of a topic."""

    def __init__(self, message_type: MessageType, data: bytes, stamp: int) -> None:
        """`stamp`: when it came by ROS's clock, ns."""
        self._type, self._data, self._stamp = message_type, data, stamp
        self._json = ""
        self._frames: dict[Form, bytes] = {}

    def __reduce_ex__(self, _: object) -> tuple[type["Delivery"], tuple[MessageType, PickleBuffer, int]]:
        return Delivery, (self._type, PickleBuffer(self._data), self._stamp)

    def __len__(self) -> int:
        """Bytes of the message."""
        return len(self._data)

    def is_of(self, data: bytes) -> bool:
        """Whether it is that very message."""
        return self._data is data

    def takes_long(self, form: Form) -> bool:
        """Whether the frames have not been made, and would keep others waiting."""
        return form not in self._frames and takes_long(self._type, self._data, form.compression)

    def take(self, form: Form, frames: bytes) -> None:
        """What `frames` has made elsewhere."""
        self._frames[form] = frames

    def frames(self, form: Form) -> bytes:
        """The WebSocket frames of one publish operation, or of its fragments. ConversionError when the message is not
        what its type says."""
        made = self._frames.get(form)
        if made is None:
            parts = outgoing(self._operation(form), form.compression, form.fragment_size)
            made = self._frames[form] = b"".join(map(frame, parts))
        return made

    def _operation(self, form: Form) -> dict[str, Any] | str:
        if form.compression == "cbor":
            return {"op": "publish", "topic": form.topic, "msg": self._type.cbor(self._data)}
        if form.compression == "cbor-raw":
            return {"op": "publish", "topic": form.topic, "msg": raw(self._data, *divmod(self._stamp, 10**9))}
        self._json = self._json or self._type.json(self._data)
        return f'{{"op":"publish","topic":{dumps(form.topic)},"msg":{self._json}}}'
