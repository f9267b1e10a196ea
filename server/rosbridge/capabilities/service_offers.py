"""advertise_service, unadvertise_service, service_response from a client (rosbridge protocol 3.3.9 to 3.3.11): ROS
calls what a client offers."""

from collections.abc import Mapping
from typing import NamedTuple

from server.messages.types import ServiceType
from server.rosbridge.capabilities.capability import Capability, Handler
from server.rosbridge.context import Context
from server.rosbridge.effects import Answer, Ask, CloseService, Effect, OpenService, Send
from server.rosbridge.large_requests import Packed, serialized
from server.rosbridge.outgoing import takes_long
from server.websocket.requests import Request, RequestError, brief, dumps

MAX_SERVICES = 100  # that one client offers
MAX_CALLS = 1000  # that wait for one client's answers


class Offer(NamedTuple):
    """A service of the client."""

    name: str  # as the client writes it
    type: ServiceType


class ServiceOffers(Capability):
    def __init__(self, client: Context) -> None:
        super().__init__(client)
        self._offers: dict[str, Offer] = {}
        self._calls: dict[str, tuple[int, str]] = {}  # by the id of the operation: the call and its service

    def handlers(self) -> Mapping[str, Handler]:
        return {
            "advertise_service": self.advertise_service,
            "unadvertise_service": self.unadvertise_service,
            "service_response": self.service_response,
        }

    def advertise_service(self, request: Request, now: float) -> list[Effect]:
        service, type_name = request.ros_name("service"), request.ros_type()
        if reason := self.client.gate.refuses_offering(self.client.identity, service):
            raise self.client.gate.refusal("advertise_service", reason)
        offer = Offer(request.text("service"), self.client.types.service(type_name))
        if service not in self._offers and len(self._offers) >= MAX_SERVICES:
            raise RequestError(f"a client may offer {MAX_SERVICES} services")
        effects: list[Effect] = []
        before = self.client.graph.offer(self, service)
        if isinstance(before, ServiceOffers):
            effects += before._close(service)
            if before is not self:
                text = f"another client of rosbridge offered {service} before, and no longer does"
                effects += self.client.report("warning", text, now, request.id)
        return [*effects, *self._open(service, offer)]

    def unadvertise_service(self, request: Request, now: float) -> list[Effect]:
        service = request.ros_name("service")
        if service not in self._offers:
            return self.client.report("warning", f"{service} is not offered by this client", now, request.id)
        self.client.graph.withdraw(service)
        return self._close(service)

    def asked(self, call: int, service: str, data: bytes, _now: float) -> list[Effect]:
        """ROS calls: hand it to the client. When too many wait for its answers, the oldest gives way: its caller may
        have gone long ago."""
        offer = self._offers.get(service)
        if offer is None:
            return [Answer(call, None, "the service is gone")]
        effects: list[Effect] = []
        if len(self._calls) >= MAX_CALLS:
            oldest, _ = self._calls.pop(next(iter(self._calls)))
            effects.append(Answer(oldest, None, "too many calls wait for this client"))
        call_id = id_of(call, service)
        operation = {"op": "call_service", "id": call_id, "service": offer.name}
        if takes_long(offer.type.request, data, "none"):
            effects.append(Ask(call, operation, offer.type.request, data))
        else:
            effects.append(Send(dumps({**operation, "args": offer.type.request.values(data)})))
        self._calls[call_id] = (call, service)
        return effects

    def owed(self) -> dict[str, str]:
        """The types of the responses that the client is to give, by the id of the call."""
        return {call_id: self._offers[service].type.response.name for call_id, (_, service) in self._calls.items()}

    def forget(self, call: int, service: str) -> None:
        """Nobody waits for the client's answer any more."""
        self._calls.pop(id_of(call, service), None)

    def service_response(self, request: Request, now: float) -> list[Effect]:
        call, service = self._calls.pop(request.id, (None, ""))  # type: ignore[arg-type]
        if call is None:
            raise RequestError(f"no call has the id {brief(request.id)}")
        values, failed = request.fields.get("values", {}), request.fields.get("result", True) is not True
        try:
            # a response that is filled in counts whatever `result` says, as upstream: handlers of roslibpy that fill it
            # in may return False or nothing
            if not failed or (values and type(values) in {dict, Packed}):
                response = self._offers[service].type.response
                return [Answer(call, serialized(response, values, self.client.clock.now), "")]
        except RequestError as error:
            if not failed:
                return [Answer(call, None, str(error)), *self.client.report("error", str(error), now, request.id)]
        return [Answer(call, None, str(values) if type(values) in {str, Packed} else brief(values))]

    def closed(self) -> list[Effect]:
        effects: list[Effect] = []
        for service in list(self._offers):
            self.client.graph.withdraw(service)
            effects += self._close(service)
        return effects

    def _open(self, service: str, offer: Offer) -> list[Effect]:
        self._offers[service] = offer
        return [OpenService(service, offer.type)]

    def _close(self, service: str) -> list[Effect]:
        del self._offers[service]
        self._calls = {call_id: call for call_id, call in self._calls.items() if call[1] != service}
        return [CloseService(service)]


def id_of(call: int, service: str) -> str:
    """The id of the operation by which the client hears of the call."""
    return f"service_request:{service}:{call}"
