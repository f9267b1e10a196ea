"""One client of rosbridge, by the rosbridge v2 protocol: requests in, effects out. No ROS, no socket, no clock.

Bad requests are answered by a status of level error, and change nothing.
"""

from dataclasses import dataclass

from server.rosbridge.capabilities import CAPABILITIES
from server.rosbridge.context import Context
from server.rosbridge.effects import Effect
from server.rosbridge.wire import Id, Request, RequestError, brief, parse


@dataclass(eq=False)
class Client(Context):
    """One connected client."""

    def __post_init__(self) -> None:
        self._capabilities = [capability(self) for capability in CAPABILITIES]
        self.handlers = {op: handler for each in self._capabilities for op, handler in each.handlers().items()}

    def receive(self, text: str | bytes, now: float) -> list[Effect]:
        """A WebSocket message has come from the client."""
        request_id: Id = None
        try:
            request = Request(parse(text))
            request_id = request.id
            op = request.text("op")
            handler = self.handlers.get(op)
            if handler is None:
                raise RequestError(f"the operation {brief(op)} is unknown here")
            return handler(request, now)
        except RequestError as error:
            return self.report("error", str(error), now, request_id)

    def updated(self, now: float) -> list[Effect]:
        """The battle has changed, or some time has passed."""
        return [effect for capability in self._capabilities for effect in capability.updated(now)]

    def closed(self) -> list[Effect]:
        """The client is gone: stop what it drove, close what it had open."""
        return [effect for capability in self._capabilities for effect in capability.closed()]
