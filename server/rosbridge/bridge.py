"""Carries out what the clients' sessions ask, and brings them what comes from ROS."""

import asyncio
import logging
from typing import Any, Protocol

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
from server.rosbridge.gate import STATUS_TOPIC, STATUS_TYPE, Gate, Identity, battle_of
from server.rosbridge.graph import Graph
from server.rosbridge.protocol import Session, neutral
from server.rosbridge.ros import Ros
from server.rosbridge.service_client import ServiceClient
from server.rosbridge.subscription import Subscription
from server.rosbridge.wire import RequestError, dumps

_log = logging.getLogger(__name__)

# How often rights are judged again though no news came, and slow clients are looked at.
TICK = 0.5  # s
GATE = "gate"  # takes part in the graph of topics as if it were a client


class Link(Protocol):
    """A client as the bridge sees it."""

    name: str

    def reply(self, text: str) -> None: ...

    def message(self, topic: str, text: str, most: int) -> None:
        """Send a topic's message; while the client is slow, keep the newest `most`."""

    def check(self, now: float) -> None:
        """Give up a client that does not read."""


class Bridge:
    """One rosbridge: all clients and ROS. For the event loop's thread only."""

    def __init__(self, node: str, operator_token: str) -> None:
        """`node` is rosbridge's ROS node name. Needs a running event loop and an initialised rospy."""
        self._loop = asyncio.get_running_loop()
        self._gate, self._drivers, self._graph, self._types = Gate(operator_token), Drivers(), Graph(), Types()
        self._links: dict[Session, Link] = {}
        self._alarms: dict[Subscription, asyncio.TimerHandle] = {}
        self._calls: set[asyncio.Task[None]] = set()
        self._ros = Ros(self._loop, self._deliver)
        self._services = ServiceClient(self._ros.registrar, self._types, f"/{node}")
        subscription = Subscription(GATE, STATUS_TOPIC)
        self._perform(None, self._graph.subscribe(STATUS_TOPIC, self._types.message(STATUS_TYPE), subscription))
        self._loop.call_later(TICK, self._tick)

    def connected(self, link: Link, identity: Identity) -> Session:
        session = Session(self._gate, self._drivers, self._graph, self._types, identity)
        self._links[session] = link
        return session

    def received(self, session: Session, text: str | bytes) -> None:
        """A WebSocket message from a client."""
        self._perform(session, session.receive(text, self._loop.time()))

    def disconnected(self, session: Session) -> None:
        del self._links[session]
        self._perform(None, session.closed())

    def stop(self) -> None:
        """The end: no robot keeps moving."""
        for topic in self._drivers.all():
            self._perform(None, [neutral(topic, self._types)])
        for task in self._calls:
            task.cancel()

    def _perform(self, session: Session | None, effects: list[Effect]) -> None:
        """Carry out the effects in order; replies and log lines only for a client that is still there."""
        link = self._links.get(session) if session else None
        for effect in effects:
            match effect:
                case Publish(topic, message):
                    self._ros.publish(topic, message)
                case Send(text):
                    if link:
                        link.reply(text)
                case Log(level, text):
                    _log.log(level, "%s: %s", link.name if link else "a client", text)
                case OpenPublisher(topic, message_type, latch):
                    self._ros.open_publisher(topic, message_type, latch)
                case ClosePublisher(topic):
                    self._ros.close_publisher(topic)
                case OpenSubscription(topic, message_type):
                    self._ros.open_subscription(topic, message_type)
                case CloseSubscription(topic):
                    self._ros.close_subscription(topic)
                case Replay(topic):
                    self._replay(session, topic)
                case CallService():
                    task = self._loop.create_task(self._call(session, effect))
                    self._calls.add(task)
                    task.add_done_callback(self._calls.discard)

    async def _call(self, session: Session | None, call: CallService) -> None:
        values, reason = None, ""
        try:
            values = await self._services.call(call.service, call.args, call.timeout)
        except RequestError as error:
            reason = str(error)
        except Exception:  # whatever it was, the client hears of the end, and its call counts no longer as under way
            _log.exception("the call of %s failed", call.service)
            reason = "the call failed"
        if session in self._links:
            self._perform(session, call.done(values, reason, self._loop.time()))

    def _replay(self, session: Session | None, topic: str) -> None:
        message = self._ros.latched(topic)
        message_type = self._graph.type_of(topic)
        if message is None or message_type is None:
            return
        body = dumps(message_type.encode(message))
        for subscription in self._graph.subscriptions(topic):
            if subscription.client is session:
                self._offer(subscription, topic, body)

    def _deliver(self, topic: str, message_type: MessageType, message: Any) -> None:
        """A message from ROS. It becomes JSON once, however many clients get it."""
        if topic == STATUS_TOPIC:
            self._battle_changed(message)
        body = ""
        for subscription in self._graph.subscriptions(topic):
            if subscription.client is not GATE:
                body = body or dumps(message_type.encode(message))
                self._offer(subscription, topic, body)

    def _offer(self, subscription: Subscription, topic: str, body: str) -> None:
        text = subscription.offer(body, self._loop.time())
        if text is not None:
            self._send(subscription, topic, text)
        elif subscription.due is not None and subscription not in self._alarms:
            self._alarms[subscription] = self._loop.call_at(subscription.due, self._release, subscription, topic)

    def _release(self, subscription: Subscription, topic: str) -> None:
        """A throttled message is due."""
        del self._alarms[subscription]
        text = subscription.release(self._loop.time())
        if text is not None:
            self._send(subscription, topic, text)
        if subscription.due is not None:
            self._alarms[subscription] = self._loop.call_at(subscription.due, self._release, subscription, topic)

    def _send(self, subscription: Subscription, topic: str, text: str) -> None:
        link = self._links.get(subscription.client)  # type: ignore[call-overload]
        if link is not None:
            link.message(topic, text, max(1, subscription.queue_length))

    def _battle_changed(self, status: Any) -> None:
        now = self._loop.time()
        self._gate.update(battle_of(status), now)
        self._judge(now)

    def _tick(self) -> None:
        self._loop.call_later(TICK, self._tick)
        now = self._loop.time()
        self._judge(now)
        for link in list(self._links.values()):
            link.check(now)

    def _judge(self, now: float) -> None:
        """Stop the robots of those who may no longer drive."""
        for topic in self._drivers.refused(self._gate, now):
            _log.info("%s is stopped: its driver may no longer drive", topic)
            self._ros.publish(topic, neutral(topic, self._types).message)
        for session in list(self._links):
            self._perform(session, session.updated(now))
