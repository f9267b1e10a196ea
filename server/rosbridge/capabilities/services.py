"""call_service and its service_response (rosbridge protocol 3.2.8, 3.2.9)."""

from collections.abc import Mapping
from typing import Any

from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.context import Context
from server.rosbridge.effects import CallService, Effect, Send
from server.rosbridge.wire import Request, RequestError, brief, dumps, with_id

DEFAULT_TIMEOUT = 10.0  # s
MAX_TIMEOUT = 60.0  # s
MAX_CALLS = 16  # under way at once, for one client


class Services(Capability):
    """Every refused or failed call is answered twice: by a status, and by a service_response with result false,
    because clients wait for the latter."""

    def __init__(self, client: Context) -> None:
        super().__init__(client)
        self._under_way = 0

    def handlers(self) -> Mapping[str, Handler]:
        return {"call_service": self.call_service}

    def call_service(self, request: Request, now: float) -> list[Effect]:
        request.text("service")
        try:
            return [self._call(request)]
        except RequestError as error:
            return self._failure(request, f"call_service: {error}", str(error), now)

    def _call(self, request: Request) -> CallService:
        service = request.ros_name("service")
        if reason := self.client.gate.refuses_calling(self.client.identity, service):
            raise RequestError(reason)
        args = request.fields.get("args") or {}
        if type(args) not in (dict, list):
            raise RequestError(f"the field 'args' must be an object or a list, not {brief(args)}")
        # a client that gives no time-out, or one that is not positive, gets the default
        timeout = request.fields.get("timeout")
        if timeout is not None and type(timeout) not in (int, float):
            raise RequestError(f"the field 'timeout' must be a number, not {brief(timeout)}")
        seconds = min(float(timeout), MAX_TIMEOUT) if timeout is not None and timeout > 0 else DEFAULT_TIMEOUT
        if request.optional_text("compression", "none") != "none":
            raise RequestError("compression is not supported; use none")
        if self._under_way >= MAX_CALLS:
            raise RequestError(f"{MAX_CALLS} service calls of this client are running already")
        self._under_way += 1

        def done(values: dict[str, Any] | None, reason: str, now: float) -> list[Effect]:
            self._under_way -= 1
            if values is not None:
                return [response(request, True, values)]
            return self._failure(request, f"call_service {service}: {reason}", reason, now)

        return CallService(service, args, seconds, done)

    def _failure(self, request: Request, text: str, reason: str, now: float) -> list[Effect]:
        return [*self.client.report("error", text, now, request.id), response(request, False, reason)]


def response(request: Request, result: bool, values: dict[str, Any] | str) -> Send:
    """`values`: the service's response, or the reason when `result` is false."""
    service = request.fields["service"]  # as the client wrote it
    operation = {"op": "service_response", "service": service, "values": values, "result": result}
    return Send(dumps(with_id(operation, request.id)))
