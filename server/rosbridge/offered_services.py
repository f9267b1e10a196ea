"""ROS calls services that clients offer: the calls that wait for a client's answer."""

import asyncio
import itertools
from collections.abc import Callable, Sequence

from server.messages.types import ConversionError
from server.rosbridge.effects import Answer, Effect
from server.rosbridge.protocol import Client
from tcpros.specs import ServiceFailure


class OfferedServices:
    """For the event loop's thread only."""

    def __init__(self, perform: Callable[[Client, Sequence[Effect]], None]) -> None:
        """`perform` carries out effects for a client."""
        self._perform = perform
        self._calls: dict[int, tuple[str, asyncio.Future[bytes]]] = {}
        self._numbers = itertools.count(1)

    async def ask(self, client: Client, service: str, request: bytes) -> bytes:
        """The client's response, both serialized; ServiceFailure when there is none. Waits as long as the client and
        the service are there."""
        call, answer = next(self._numbers), asyncio.Future[bytes]()
        self._calls[call] = (service, answer)
        try:
            self._perform(client, client.asked(call, service, request, asyncio.get_running_loop().time()))
            return await answer
        except ConversionError as error:
            raise ServiceFailure(str(error)) from None
        finally:
            del self._calls[call]
            client.forget_call(call, service)

    def answer(self, effect: Answer) -> None:
        _, answer = self._calls.get(effect.call, ("", None))
        if answer is None or answer.done():  # the caller has gone
            return
        if effect.data is None:
            answer.set_exception(ServiceFailure(effect.reason))
        else:
            answer.set_result(effect.data)

    def fail(self, service: str) -> None:
        """The service is no longer there."""
        for asked, answer in self._calls.values():
            if asked == service and not answer.done():
                answer.set_exception(ServiceFailure(f"{service} is gone"))
