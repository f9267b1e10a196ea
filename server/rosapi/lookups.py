"""rosapi's services that tell who is there: topics, services and nodes, as the ROS master knows them."""

import asyncio
from typing import Any

import genpy

from laser_bot_battle.master import MasterError
from server.access.globs import Globs
from server.messages.outside import Outside
from server.messages.types import known_service, known_type
from server.rosapi.handlers import Handler, Values, global_name
from server.rosapi.system_state import SystemState, action_servers, shown, used_by
from server.websocket.requests import RequestError
from tcpros.node import Node
from tcpros.specs import ServiceError

# A service's type is known to the service only: each is asked, some at the same time.
ASKED_AT_ONCE = 16
PATIENCE = 2.0  # s, with one service


class Lookups:
    """Names that nobody uses, or that the globs hide, have no type and no nodes: an empty string or list."""

    def __init__(self, node: Node, globs: Globs, outside: Outside) -> None:
        self._node = node
        self._globs = globs
        self._outside = outside

    def handlers(self) -> dict[str, tuple[str, Handler]]:
        return {
            "topics": ("Topics", self.topics),
            "topics_for_type": ("TopicsForType", self.topics_for_type),
            "topics_and_raw_types": ("TopicsAndRawTypes", self.topics_and_raw_types),
            "topic_type": ("TopicType", self.topic_type),
            "publishers": ("Publishers", self.publishers),
            "subscribers": ("Subscribers", self.subscribers),
            "action_servers": ("GetActionServers", self.action_servers),
            "services": ("Services", self.services),
            "services_for_type": ("ServicesForType", self.services_for_type),
            "service_type": ("ServiceType", self.service_type),
            "service_providers": ("ServiceProviders", self.service_providers),
            "service_node": ("ServiceNode", self.service_node),
            "service_host": ("ServiceHost", self.service_host),
            "nodes": ("Nodes", self.nodes),
            "node_details": ("NodeDetails", self.node_details),
        }

    async def topics(self, _: Values) -> Values:
        topics = await self._topic_types()
        return {"topics": list(topics), "types": list(topics.values())}

    async def topics_for_type(self, request: Values) -> Values:
        topics = await self._topic_types()
        return {"topics": [topic for topic, kind in topics.items() if kind == request["type"]]}

    async def topics_and_raw_types(self, _: Values) -> bytes:
        return await self._outside.make(topics_and_raw_types, await self._topic_types())

    async def topic_type(self, request: Values) -> Values:
        return {"type": (await self._topic_types()).get(global_name(request["topic"]), "")}

    async def publishers(self, request: Values) -> Values:
        topic, state = global_name(request["topic"]), await self._state()
        return {"publishers": state.publishers.get(topic, [])}

    async def subscribers(self, request: Values) -> Values:
        topic, state = global_name(request["topic"]), await self._state()
        return {"subscribers": state.subscribers.get(topic, [])}

    async def action_servers(self, _: Values) -> Values:
        return {"action_servers": action_servers((await self._state()).topics())}

    async def services(self, _: Values) -> Values:
        return {"services": sorted((await self._state()).services)}

    async def services_for_type(self, request: Values) -> Values:
        types = await self._service_types(await self._state())
        return {"services": [service for service, kind in types.items() if kind == request["type"]]}

    async def service_type(self, request: Values) -> Values:
        service = global_name(request["service"])
        return {"type": await self._service_type(service) if self._globs.allows_service(service) else ""}

    async def service_providers(self, request: Values) -> Values:
        """The nodes that serve this type, which the field `service` holds."""
        state = await self._state()
        types = await self._service_types(state)
        services = [service for service, kind in types.items() if kind == request["service"]]
        return {"providers": sorted({node for service in services for node in state.services[service]})}

    async def service_node(self, request: Values) -> Values:
        service, state = global_name(request["service"]), await self._state()
        return {"node": next(iter(state.services.get(service, [])), "")}

    async def service_host(self, request: Values) -> Values:
        service = global_name(request["service"])
        if not self._globs.allows_service(service):
            return {"host": ""}
        try:
            uri = str(await self._node.master("lookupService", service))
        except MasterError:
            return {"host": ""}
        return {"host": uri.removeprefix("rosrpc://").rpartition(":")[0]}

    async def nodes(self, _: Values) -> Values:
        return {"nodes": SystemState.of(await self._node.master("getSystemState")).nodes()}

    async def node_details(self, request: Values) -> Values:
        node, state = global_name(request["node"]), await self._state()
        return {
            "subscribing": used_by(node, state.subscribers),
            "publishing": used_by(node, state.publishers),
            "services": used_by(node, state.services),
        }

    async def _state(self) -> SystemState:
        """What the globs show of it."""
        state = SystemState.of(await self._node.master("getSystemState"))
        return SystemState(
            shown(state.publishers, self._globs.allows_topic),
            shown(state.subscribers, self._globs.allows_topic),
            shown(state.services, self._globs.allows_service),
        )

    async def _topic_types(self) -> dict[str, str]:
        """The topics in use. The master remembers the types of others, too, and of some it knows none."""
        state = await self._state()
        types: dict[str, Any] = dict(await self._node.master("getTopicTypes"))
        return {topic: types.get(topic, "") for topic in state.topics()}

    async def _service_types(self, state: SystemState) -> dict[str, str]:
        turns = asyncio.Semaphore(ASKED_AT_ONCE)

        async def ask(service: str) -> str:
            async with turns:
                return await self._service_type(service)

        services = sorted(state.services)
        return dict(zip(services, await asyncio.gather(*map(ask, services)), strict=True))

    async def _service_type(self, service: str) -> str:
        """Empty when there is no such service, or it does not answer."""
        try:
            return (await self._node.probe(service, PATIENCE)).get("type", "")
        except ServiceError:
            return ""


def topics_and_raw_types(topics: dict[str, str]) -> bytes:
    """The serialized response. Large systems have thousands of definitions, each to be loaded and packed."""
    response = known_service("rosapi/TopicsAndRawTypes").response
    texts = {name: _full_text(name) for name in set(topics.values())}
    values = {
        "topics": list(topics),
        "types": list(topics.values()),
        "typedefs_full_text": [texts[name] for name in topics.values()],
    }
    return response.pack(values, genpy.Time)


def _full_text(name: str) -> str:
    try:
        return known_type(name).definition
    except RequestError as error:
        return f"# failed to get full definition text for {name}: {error}"
