"""call_service and its service_response (rosbridge protocol 3.2.8, 3.2.9)."""

import math
from collections.abc import Mapping, Sequence

from server.rosbridge.capabilities.capability import Capability, Handler, compression, fragment_size
from server.rosbridge.compression import COMPRESSIONS
from server.rosbridge.context import Context
from server.rosbridge.effects import CallService, Effect, Reply, Send
from server.rosbridge.large_requests import Kept
from server.websocket.requests import MAX_NUMBER, Request, RequestError, brief, dumps, with_id

MAX_CALLS = 100  # under way at once, for one client


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
            raise self.client.gate.refusal("call_service", reason)
        args = request.fields.get("args") or {}
        if type(args) not in (dict, list, Kept):
            raise RequestError(f"the field 'args' must be an object or a list, not {brief(args)}")
        # without a time-out, or with one that is not positive, the call ends with its client at the latest
        timeout = request.fields.get("timeout")
        if timeout is not None and type(timeout) not in (int, float):
            raise RequestError(f"the field 'timeout' must be a number, not {brief(timeout)}")
        seconds = float(min(timeout, MAX_NUMBER)) if timeout is not None and timeout > 0 else math.inf
        form, size = compression(request, COMPRESSIONS), fragment_size(request)
        if self._under_way >= MAX_CALLS:
            raise RequestError(f"{MAX_CALLS} service calls of this client are running already")
        self._under_way += 1

        def done(messages: Sequence[str | bytes], reason: str, now: float) -> list[Effect]:
            self._under_way -= 1
            if not messages:
                return self._failure(request, f"call_service {service}: {reason}", reason, now)
            first, *rest = messages
            return [Send(first, tuple(rest))]

        return CallService(service, args, seconds, Reply(_operation(request), form, size), done)

    def _failure(self, request: Request, text: str, reason: str, now: float) -> list[Effect]:
        response = {**_operation(request), "values": reason, "result": False}
        return [*self.client.report("error", text, now, request.id), Send(dumps(response))]


def _operation(request: Request) -> dict[str, object]:
    """The beginning of a service_response; the service as the client wrote it."""
    return with_id({"op": "service_response", "service": request.fields["service"]}, request.id)
