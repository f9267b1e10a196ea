"""set_level, and status from a client (rosbridge protocol: status messages)."""

import logging
from collections.abc import Mapping

from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.context import SEVERITY
from server.rosbridge.effects import Effect, Log
from server.websocket.requests import Request, RequestError, brief


class Status(Capability):
    def handlers(self) -> Mapping[str, Handler]:
        return {"set_level": self.set_level, "status": self.status}

    def set_level(self, request: Request, _now: float) -> list[Effect]:
        """From now on only statuses of this level and worse reach the client."""
        self.client.status_level = level(request)
        return []

    def status(self, request: Request, now: float) -> list[Effect]:
        """A client's own word for the log."""
        level(request)
        return self.client.log(Log(logging.INFO, f"says: {brief(request.text('msg'))}"), now)


def level(request: Request) -> str:
    value = request.text("level")
    if value not in SEVERITY:
        raise RequestError(f"the field 'level' must be one of {', '.join(SEVERITY)}, not {brief(value)}")
    return value
