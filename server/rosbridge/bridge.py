"""Carries out what the clients ask, and brings them what comes from ROS."""

import asyncio
import logging
from collections.abc import Sequence
from typing import Any

from laser_bot_battle.names import GAME_STATUS
from server.rosbridge.connection import Connection
from server.rosbridge.conversion import MessageType, Types
from server.rosbridge.drivers import Drivers
from server.rosbridge.effects import (
    CallService,
    ClosePublisher,
    CloseSubscription,
    Effect,
    Log,
    OpenPublisher,
    OpenSubscription,
    Publish,
    Replay,
    Send,
)
from server.rosbridge.gate import STATUS_TYPE, Gate, Identity
from server.rosbridge.graph import Graph
from server.rosbridge.protocol import Client
from server.rosbridge.ros import Ros
from server.rosbridge.service_client import ServiceClient
from server.rosbridge.subscription import Subscription
from server.rosbridge.wire import RequestError, dumps

_log = logging.getLogger(__name__)

# How often rights are checked again though no news came, and slow clients are looked at.
TICK = 0.5  # s
GATE = "gate"  # takes part in the graph of topics as if it were a client


class Bridge:
    """One rosbridge: all clients and ROS. For the event loop's thread only."""

    def __init__(self, node: str, operator_token: str) -> None:
        """`node` is rosbridge's ROS node name. Needs a running event loop and an initialised rospy."""
        self._loop = asyncio.get_running_loop()
        self._gate, self._drivers, self._graph, self._types = Gate(operator_token), Drivers(), Graph(), Types()
        self._connections: dict[Client, Connection] = {}
        self._timers: dict[Subscription, asyncio.TimerHandle] = {}
        self._calls: set[asyncio.Task[None]] = set()
        self._ros = Ros(self._loop, self._deliver)
        self._services = ServiceClient(self._ros.registrar, self._types, f"/{node}")
        subscription = Subscription(GATE, GAME_STATUS)
        self._perform(None, self._graph.subscribe(GAME_STATUS, self._types.message(STATUS_TYPE), subscription))
        self._loop.call_later(TICK, self._tick)

    def connected(self, connection: Connection, identity: Identity) -> Client:
        client = Client(self._gate, self._drivers, self._graph, self._types, identity)
        self._connections[client] = connection
        return client

    def received(self, client: Client, text: str | bytes) -> None:
        """A WebSocket message from a client."""
        self._perform(client, client.receive(text, self._loop.time()))

    def disconnected(self, client: Client) -> None:
        del self._connections[client]
        self._perform(None, client.closed())

    def stop(self) -> None:
        """The end: no robot keeps moving."""
        self._perform(None, self._drivers.stop_all())
        for task in self._calls:
            task.cancel()

    def _perform(self, client: Client | None, effects: Sequence[Effect]) -> None:
        """Carry out the effects in order; replies and log lines only for a client that is still there."""
        connection = self._connections.get(client) if client else None
        for effect in effects:
            match effect:
                case Publish(topic, message):
                    self._ros.publish(topic, message)
                case Send(text):
                    if connection:
                        connection.reply(text)
                case Log(level, text):
                    _log.log(level, "%s: %s", connection.name if connection else "a client", text)
                case OpenPublisher(topic, message_type, latch):
                    self._ros.open_publisher(topic, message_type, latch)
                case ClosePublisher(topic):
                    self._ros.close_publisher(topic)
                case OpenSubscription(topic, message_type):
                    self._ros.open_subscription(topic, message_type)
                case CloseSubscription(topic):
                    self._ros.close_subscription(topic)
                case Replay(topic):
                    self._replay(client, topic)
                case CallService():
                    task = self._loop.create_task(self._call(client, effect))
                    self._calls.add(task)
                    task.add_done_callback(self._calls.discard)

    async def _call(self, client: Client | None, call: CallService) -> None:
        values, reason = None, ""
        try:
            values = await self._services.call(call.service, call.args, call.timeout)
        except RequestError as error:
            reason = str(error)
        except Exception:  # whatever it was, the client hears of the end, and its call counts no longer as under way
            _log.exception("the call of %s failed", call.service)
            reason = "the call failed"
        if client in self._connections:
            self._perform(client, call.done(values, reason, self._loop.time()))

    def _replay(self, client: Client | None, topic: str) -> None:
        message = self._ros.latched(topic)
        message_type = self._graph.type_of(topic)
        if message is None or message_type is None:
            return
        body = dumps(message_type.encode(message))
        for subscription in self._graph.subscriptions(topic):
            if subscription.client is client:
                self._offer(subscription, topic, body)

    def _deliver(self, topic: str, message_type: MessageType, message: Any) -> None:
        """A message from ROS. It becomes JSON once, however many clients get it."""
        if topic == GAME_STATUS:
            self._gate.update(message, self._loop.time())
            self._check_rights()
        body = ""
        for subscription in self._graph.subscriptions(topic):
            if subscription.client is not GATE:
                body = body or dumps(message_type.encode(message))
                self._offer(subscription, topic, body)

    def _offer(self, subscription: Subscription, topic: str, body: str) -> None:
        self._send(subscription, topic, subscription.offer(body, self._loop.time()))

    def _release(self, subscription: Subscription, topic: str) -> None:
        """A throttled message is due."""
        del self._timers[subscription]
        self._send(subscription, topic, subscription.release(self._loop.time()))

    def _send(self, subscription: Subscription, topic: str, text: str | None) -> None:
        """Send the text, if any, and set a timer for what must wait."""
        connection = self._connections.get(subscription.client)  # type: ignore[call-overload]
        if text is not None and connection is not None:
            connection.message(topic, text, max(1, subscription.queue_length))
        if subscription.due is not None and subscription not in self._timers:
            self._timers[subscription] = self._loop.call_at(subscription.due, self._release, subscription, topic)

    def _tick(self) -> None:
        self._loop.call_later(TICK, self._tick)
        self._check_rights()
        now = self._loop.time()
        for connection in list(self._connections.values()):
            connection.check(now)

    def _check_rights(self) -> None:
        """Stop the robots of those who may no longer drive, and tell the clients that the battle may have changed."""
        now = self._loop.time()
        stops = self._drivers.stop_refused(self._gate, now)
        for stop in stops:
            _log.info("%s is stopped: its driver may no longer drive", stop.topic)
        self._perform(None, stops)
        for client in list(self._connections):
            self._perform(client, client.updated(now))
