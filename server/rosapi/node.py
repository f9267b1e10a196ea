"""The node `rosapi`: 25 services, as upstream's rosapi 0.11 has them (wiki.ros.org/rosapi)."""

from collections.abc import Callable, Coroutine
from typing import Any

from laser_bot_battle.master import MasterError
from server.access.globs import Globs
from server.messages.outside import Outside
from server.messages.types import ServiceType, Types
from server.rosapi.details import Details
from server.rosapi.handlers import NODE, Handler
from server.rosapi.lookups import Lookups
from server.rosapi.params import Params
from server.websocket.requests import RequestError
from tcpros.clock import Clock
from tcpros.node import Node
from tcpros.specs import ServiceFailure, ServiceSpec


async def start_rosapi(node: Node, types: Types, clock: Clock, globs: Globs, outside: Outside) -> None:
    """Serve all on `node`, which is started, until it is closed; what takes long is done `outside`. ConversionError
    when its types have not been made."""
    for part in (Lookups(node, globs, outside), Details(types, clock), Params(node, globs)):
        for name, (type_name, handler) in part.handlers().items():
            service = types.service(f"rosapi/{type_name}")
            node.serve(f"{NODE}/{name}", ServiceSpec(service.name, service.md5sum), serialized(service, handler, clock))


def serialized(service: ServiceType, handler: Handler, clock: Clock) -> Callable[[bytes], Coroutine[Any, Any, bytes]]:
    """`handler` as TCPROS wants it."""

    async def answer(request: bytes) -> bytes:
        try:
            response = await handler(service.request.values(request))
            return service.response.pack(response, clock.now) if isinstance(response, dict) else response
        except (RequestError, RuntimeError, MasterError) as error:
            raise ServiceFailure(str(error)) from None
        except OSError as error:
            raise ServiceFailure(f"the ROS master does not answer: {error}") from None

    return answer
