"""rosapi's services that tell what types are made of, and what time it is."""

from typing import Any

from server.messages.types import Types
from server.rosapi.handlers import Handler, Values
from server.rosapi.typedefs import class_typedefs, message_typedefs
from tcpros.clock import Clock


class Details:
    """A type that is unknown here is an error."""

    def __init__(self, types: Types, clock: Clock) -> None:
        self._types, self._clock = types, clock

    def handlers(self) -> dict[str, tuple[str, Handler]]:
        return {
            "message_details": ("MessageDetails", self.message_details),
            "service_request_details": ("ServiceRequestDetails", self.service_request_details),
            "service_response_details": ("ServiceResponseDetails", self.service_response_details),
            "get_time": ("GetTime", self.get_time),
        }

    async def message_details(self, request: Values) -> Values:
        return {"typedefs": message_typedefs(self._types, request["type"])}

    async def service_request_details(self, request: Values) -> Values:
        return self._class_details(self._types.service(request["type"]).request.message_class)

    async def service_response_details(self, request: Values) -> Values:
        return self._class_details(self._types.service(request["type"]).response.message_class)

    async def get_time(self, _: Values) -> Values:
        now = self._clock.now()
        return {"time": {"secs": now.secs, "nsecs": now.nsecs}}

    def _class_details(self, message_class: type[Any]) -> Values:
        return {"typedefs": class_typedefs(self._types, message_class)}
