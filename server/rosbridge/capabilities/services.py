"""call_service and its service_response (rosbridge protocol 3.2.8, 3.2.9)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from server.rosbridge.capabilities.capability import Family, Handler
from server.rosbridge.effects import CallService, Effect, Send
from server.rosbridge.names import resolve
from server.rosbridge.wire import Id, Request, RequestError, brief, dumps, with_id

if TYPE_CHECKING:
    from server.rosbridge.protocol import Session

DEFAULT_TIMEOUT = 10.0  # s
LONGEST_TIMEOUT = 60.0  # s
MOST_CALLS = 16  # under way at once, for one client


class Services(Family):
    """Every refused or failed call is answered twice: by a status, and by a service_response with result false,
    because clients wait for the latter."""

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._under_way = 0

    def handlers(self) -> Mapping[str, Handler]:
        return {"call_service": self.call_service}

    def call_service(self, request: Request, now: float) -> list[Effect]:
        name = request.text("service")
        try:
            return [self._call(request, name)]
        except RequestError as error:
            return [
                *self.session.report("error", f"call_service: {error}", now, request.id),
                Send(response(name, request.id, False, str(error))),
            ]

    def _call(self, request: Request, name: str) -> CallService:
        service = resolve(name)
        if reason := self.session.gate.refuses_calling(self.session.identity, service):
            raise RequestError(reason)
        args = request.fields.get("args") or {}
        if type(args) not in (dict, list):
            raise RequestError(f"the field 'args' must be an object or a list, not {brief(args)}")
        # a client that gives no time-out, or one that is not positive, gets the default
        timeout = request.fields.get("timeout")
        if timeout is not None and type(timeout) not in (int, float):
            raise RequestError(f"the field 'timeout' must be a number, not {brief(timeout)}")
        seconds = min(float(timeout), LONGEST_TIMEOUT) if timeout is not None and timeout > 0 else DEFAULT_TIMEOUT
        if request.optional_text("compression", "none") != "none":
            raise RequestError("no compression is supported, only none")
        if self._under_way >= MOST_CALLS:
            raise RequestError(f"{MOST_CALLS} service calls of this client are under way already")
        self._under_way += 1

        def done(values: dict[str, Any] | None, reason: str, now: float) -> list[Effect]:
            self._under_way -= 1
            if values is not None:
                return [Send(response(name, request.id, True, values))]
            return [
                *self.session.report("error", f"call_service {service}: {reason}", now, request.id),
                Send(response(name, request.id, False, reason)),
            ]

        return CallService(service, args, seconds, done)


def response(service: str, request_id: Id, result: bool, values: dict[str, Any] | str) -> str:
    """`service` as the client wrote it; `values` the response, or the reason when `result` is false."""
    return dumps(
        with_id({"op": "service_response", "service": service, "values": values, "result": result}, request_id)
    )
