"""fragment, png: a request that comes in parts, or within a picture (rosbridge protocol 3.1.2, 3.1.3)."""

from collections.abc import Mapping

from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.compression import from_png
from server.rosbridge.context import Context
from server.rosbridge.effects import Effect, Unpack
from server.rosbridge.fragments import Reassembly
from server.rosbridge.large_requests import LARGE_TEXT, refuse_nested
from server.websocket.requests import Request, RequestError, parse

# Characters of all parts that wait for the rest: as much as one message may have.
MAX_SIZE = 8 * 2**20
MAX_SIZE_OF_GUESTS = 64 * 2**10


class Wrapping(Capability):
    def __init__(self, client: Context) -> None:
        super().__init__(client)
        self._reassembly = Reassembly()

    def handlers(self) -> Mapping[str, Handler]:
        return {"fragment": self.fragment, "png": self.png}

    def fragment(self, request: Request, now: float) -> list[Effect]:
        self._reassembly.max_size = MAX_SIZE if self.client.identity.operator else MAX_SIZE_OF_GUESTS
        text = self._reassembly.add(request, now)
        return [] if text is None else self._unwrap(text, "fragment", now)

    def png(self, request: Request, now: float) -> list[Effect]:
        # a short message may hold a long text, and the first one costs the time of loading what unpacks it
        if not self.client.identity.operator:
            raise RequestError("only operators may send pictures")
        return self._unwrap(from_png(request.text("data")), "png", now)

    def updated(self, now: float) -> list[Effect]:
        self._reassembly.expire(now)
        return []

    def _unwrap(self, text: str, wrapper: str, now: float) -> list[Effect]:
        """Carry out what was inside."""
        if len(text) > LARGE_TEXT:
            return [Unpack(text, wrapper)]
        fields = parse(text)
        refuse_nested(fields, wrapper)
        return self.client.handle(Request(fields), now)
