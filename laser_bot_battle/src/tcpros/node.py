"""A ROS 1 node on the running event loop."""

import asyncio
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from laser_bot_battle.master import MasterError
from tcpros import sockets, xmlrpc_client
from tcpros.inbound import Inbound
from tcpros.incoming import Received
from tcpros.publisher import Publisher
from tcpros.registrations import Registration, Registrations
from tcpros.service import Handler, Service
from tcpros.service_call import MakeRequest, ServiceCaller
from tcpros.slave_api import SlaveApi
from tcpros.specs import ANY, ServiceSpec, TypeSpec
from tcpros.subscriber import Subscriber
from tcpros.xmlrpc_server import XmlRpcServer

MASTER_TIMEOUT = 5.0  # s
# Calls of the master at the same time, besides registrations; each costs it a thread.
MASTER_CALLS = 16
END_WITHIN = 0.5  # s


class Node:
    """All methods are for the event loop's thread, and none blocks."""

    def __init__(self, name: str, master_uri: str) -> None:
        """`name` with or without its leading slash."""
        self.name = "/" + name.lstrip("/")
        self.master_uri = master_uri
        self.uri = ""
        """of the Slave API; known once started"""
        self.on_shutdown: Callable[[str], None] = lambda reason: None
        """called with the reason when somebody asks the node to end"""
        self.tcpros_address = ("", 0)
        self._master_calls = asyncio.Semaphore(MASTER_CALLS)
        self._slave = XmlRpcServer(SlaveApi(self).handle)
        self._registrations = Registrations(self._call_master)
        self._caller = ServiceCaller(self.name, self.master)
        self._publishers: dict[str, Publisher] = {}
        self._subscribers: dict[str, list[Subscriber]] = {}
        self._sources: dict[str, list[str]] = {}  # the publishers that the master named last, by topic
        self._services: dict[str, Service] = {}
        self._inbound = Inbound(self.name, self._publishers, self._services)

    async def start(self) -> None:
        """Listen, and register what is there already. OSError when the address of this machine is impossible."""
        self.tcpros_address = (sockets.host(), self._inbound.start())
        slave = sockets.listen()
        self.uri = f"http://{sockets.host()}:{slave.getsockname()[1]}/"
        await self._slave.start(slave)
        self._registrations.start()

    async def close(self) -> None:
        """Unregister all, as far as the master answers in half a second, and end all connections."""
        for publisher in self.publishers():
            publisher.close()
        subscribers = self.subscribers()
        for subscriber in subscribers:
            subscriber.close()
        for service in tuple(self._services.values()):
            service.close()
        await self._registrations.close(END_WITHIN)
        await self._slave.close()
        await self._inbound.close()
        await asyncio.gather(*(subscriber.finished() for subscriber in subscribers))

    async def master(self, method: str, *arguments: Any, timeout: float = MASTER_TIMEOUT) -> Any:
        """Call a method of the Master or the parameter API; the value that it returns.

        MasterError when it reports a failure, OSError when there is no such answer within `timeout` s.
        """
        try:
            async with asyncio.timeout(timeout), self._master_calls:
                return await self._call_master(method, *arguments, timeout=timeout)
        except TimeoutError:
            raise TimeoutError(f"{self.master_uri} has not answered within {timeout:g} s") from None

    def advertise(self, topic: str, spec: TypeSpec, *, latch: bool = False, latest: bool = False) -> Publisher:
        """Publish on `topic`, which must not be advertised here already.

        A subscriber that does not read has the newest 1000 messages, at most 4 MiB, waiting. `latch`: the last message
        goes to every newcomer. `latest`: a message that cannot be sent at once is dropped, and none is ever kept.
        """
        if topic in self._publishers:
            raise ValueError(f"{topic} is advertised already")
        publisher = self._publishers[topic] = Publisher(topic, spec, latch, latest, self._unadvertised)
        answered = partial(self._registered, publisher)
        self._registrations.want(Registration("Publisher", topic, spec.name, self.uri, answered))
        return publisher

    def subscribe(self, topic: str, spec: TypeSpec, received: Received) -> Subscriber:
        """Have `received(data, header)` called with every message, and the header of the publisher's connection."""
        subscriber = Subscriber(self.name, topic, spec, received, self._unsubscribed)
        others = self._subscribers.setdefault(topic, [])
        others.append(subscriber)
        if len(others) == 1:
            self._register_subscriber(topic, spec)
        else:
            subscriber.update(self._sources.get(topic, ()))
        return subscriber

    def serve(self, service: str, spec: ServiceSpec, handler: Handler) -> Service:
        """Offer `service`, which must not be served here already: `await handler(request)` gives the response.

        ServiceFailure from the handler goes to the caller as text.
        """
        if service in self._services:
            raise ValueError(f"{service} is served already")
        served = self._services[service] = Service(service, spec, handler, self._unserved)
        host, port = self.tcpros_address
        self._registrations.want(Registration("Service", service, f"rosrpc://{host}:{port}", self.uri))
        return served

    async def call(
        self, service: str, make_request: MakeRequest, timeout: float, md5sum: str = ANY
    ) -> tuple[bytes, Mapping[str, str]]:
        """The response of `service`, serialized, and its header with `type` and `md5sum`.

        `make_request(header)` gives the serialized request; what it raises ends the call. ServiceError otherwise.
        """
        return await self._caller.call(service, make_request, timeout, md5sum)

    async def probe(self, service: str, timeout: float = MASTER_TIMEOUT) -> Mapping[str, str]:
        """The header of `service`, with `type` and `md5sum`; nothing is called. ServiceError."""
        return await self._caller.probe(service, timeout)

    def publishers(self) -> list[Publisher]:
        return list(self._publishers.values())

    def subscribers(self) -> list[Subscriber]:
        return [subscriber for several in self._subscribers.values() for subscriber in several]

    def publisher_update(self, topic: str, publishers: list[str]) -> None:
        """The master names the publishers of `topic`."""
        if topic in self._subscribers:
            self._sources[topic] = publishers
            for subscriber in self._subscribers[topic]:
                subscriber.update(publishers)

    def shut_down(self, reason: str) -> None:
        self.on_shutdown(reason)

    async def _call_master(self, method: str, *arguments: Any, timeout: float = MASTER_TIMEOUT) -> Any:
        """Without waiting for other calls."""
        try:
            answer = await xmlrpc_client.call(self.master_uri, method, self.name, *arguments, timeout=timeout)
        except xmlrpc_client.UnsendableError as error:
            raise MasterError(f"the master cannot be told this: {error}") from None
        try:
            code, text, value = answer
        except (TypeError, ValueError):
            raise OSError(f"{self.master_uri} does not answer as a ROS master") from None
        if code != 1:
            raise MasterError(text)
        return value

    async def _registered(self, publisher: Publisher, uris: Any) -> None:
        """Tell the publisher who was there before it. The master has named the URIs only."""
        nodes: set[str] = set()
        if uris and not publisher.latest:
            try:
                _, subscribed, _ = await self._call_master("getSystemState")
                nodes = set(dict(subscribed).get(publisher.topic, ()))
            except (TypeError, ValueError):
                raise OSError(f"{self.master_uri} does not answer as a ROS master") from None
        publisher.registered(nodes)

    def _register_subscriber(self, topic: str, spec: TypeSpec) -> None:
        async def answered(publishers: Any) -> None:
            # what the master has said since is newer
            if topic not in self._sources and isinstance(publishers, list):
                self.publisher_update(topic, [str(uri) for uri in publishers])

        self._registrations.want(Registration("Subscriber", topic, spec.name, self.uri, answered))

    def _unadvertised(self, publisher: Publisher) -> None:
        if self._publishers.get(publisher.topic) is publisher:
            del self._publishers[publisher.topic]
            self._registrations.drop(("Publisher", publisher.topic))

    def _unsubscribed(self, subscriber: Subscriber) -> None:
        others = self._subscribers.get(subscriber.topic, [])
        if subscriber in others:
            others.remove(subscriber)
            if not others:
                del self._subscribers[subscriber.topic]
                self._sources.pop(subscriber.topic, None)
                self._registrations.drop(("Subscriber", subscriber.topic))

    def _unserved(self, service: Service) -> None:
        if self._services.get(service.name) is service:
            del self._services[service.name]
            self._registrations.drop(("Service", service.name))
