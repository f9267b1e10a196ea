"""Carries out what the clients ask, and brings them what comes from ROS."""

import asyncio
import logging
import time
from collections.abc import Callable, Coroutine, Iterable, Sequence
from functools import partial
from pickle import PickleBuffer
from typing import Any

import genpy
from prometheus_client.core import Metric

from laser_bot_battle.msg import GameStatus
from laser_bot_battle.names import GAME_STATUS, SHOTS
from server.access.identity import OPERATOR, Identity
from server.messages.outside import Outside
from server.messages.types import ConversionError, MessageType, Types
from server.rosbridge.context import OWN_TYPES
from server.rosbridge.delivery import Delivery
from server.rosbridge.drivers import Drivers
from server.rosbridge.effects import (
    Answer,
    Ask,
    CallService,
    ClosePublisher,
    CloseService,
    CloseSubscription,
    Effect,
    FindType,
    GoOn,
    Later,
    Log,
    OpenPublisher,
    OpenService,
    OpenSubscription,
    Publish,
    Read,
    Replay,
    Response,
    Send,
    Unlatch,
    Unpack,
)
from server.rosbridge.gate import STATUS_TYPE, Gate
from server.rosbridge.graph import Graph
from server.rosbridge.large_requests import read, unpacked
from server.rosbridge.metrics import Delays, metrics, missing
from server.rosbridge.offered_services import OfferedServices
from server.rosbridge.outgoing import asked_frames, replied, replied_frames, takes_long
from server.rosbridge.protocol import Client
from server.rosbridge.ros import Ros
from server.rosbridge.shots import SHOT_TYPE
from server.rosbridge.subscription import Subscription
from server.rosbridge.topic_queue import TopicQueue
from server.websocket.connection import Connection
from server.websocket.frames import Framed
from server.websocket.limits import SocketOwner, owner_of
from server.websocket.requests import Request, RequestError, one_line
from tcpros.clock import Clock
from tcpros.node import Node

_log = logging.getLogger(__name__)

# How often rights are checked again though no news came.
TICK = 0.5  # s
# A client's last call of a service may still be on its way there when the client has gone.
LAST_CALL = 10.0  # s
# A publish waits no longer for what the client has subscribed to before, whatever hangs.
LATER = 1.0  # s
_HOLDING = (Unpack, Read, GoOn)  # what a client has sent since waits for these
GATE = "gate"  # takes part in the graph of topics as if it were a client


class Bridge:
    """One rosbridge: all clients and ROS. For the event loop's thread only."""

    def __init__(self, node: Node, types: Types, clock: Clock, gate: Gate, is_open: bool) -> None:
        """`is_open`: everybody may do what an operator may. Needs a running event loop."""
        self._loop = asyncio.get_running_loop()
        self._gate, self._types, self._clock, self._is_open = gate, types, clock, is_open
        self._drivers, self._graph, self._delays = Drivers(), Graph(), Delays()
        self._connections: dict[Client, Connection] = {}
        self._timers: dict[Subscription, asyncio.TimerHandle] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._calls: dict[asyncio.Task[None], Client | None] = {}  # of services, by whom
        self._offered = OfferedServices(self._perform)
        self.outside = Outside()
        # messages, each for some subscriptions, of topics of which a large one is being encoded
        self._queues: dict[str, TopicQueue] = {}
        self._latest: Delivery | None = None  # large one: who comes soon after it gets what has been encoded
        self._ros = ros = Ros(node, types, clock, self.outside, deliver=self._deliver, troubled=self._troubled)
        self._performers: dict[type, Callable[[Client | None, Any], object]] = {
            Publish: lambda client, effect: ros.publish(effect.topic, effect.data, client),
            Unlatch: lambda client, effect: ros.unlatch(effect.topic, client),
            Send: self._send,
            Unpack: partial(self._hold, self._unpack),
            Read: partial(self._hold, self._read),
            GoOn: partial(self._hold, self._go_on),
            Log: self._log,
            OpenPublisher: lambda _, effect: ros.open_publisher(*effect),
            ClosePublisher: lambda _, effect: ros.close_publisher(*effect),
            OpenSubscription: lambda client, effect: self._open_subscription(client, *effect),
            CloseSubscription: lambda _, effect: ros.close_subscription(*effect),
            Replay: lambda client, effect: self._replay(client, effect.topic),
            FindType: lambda client, effect: self._start(self._find_type(client, effect)),
            Later: self._later,
            CallService: self._start_call,
            OpenService: self._open_service,
            CloseService: self._close_service,
            Ask: lambda client, effect: self._start(self._ask(client, effect)),
            Answer: lambda _, effect: self._offered.answer(effect),
        }
        self._status_type = types.message(STATUS_TYPE)
        subscription = Subscription(GATE, GAME_STATUS)
        self._perform(None, self._graph.subscribe(GAME_STATUS, self._status_type, subscription))
        # from the beginning: the referee trusts light alone as long as nobody is there who tells of shots
        self._perform(None, self._graph.advertise(GATE, SHOTS, types.message(SHOT_TYPE), latch=False))
        self._loop.call_later(TICK, self._tick)

    def connected(self, connection: Connection, identity: Identity) -> Client:
        who = OPERATOR if self._is_open else identity
        client = Client(self._gate, self._drivers, self._graph, self._types, self._clock, who, connection.address)
        self._connections[client] = connection
        return client

    def owner(self, identity: Identity, address: str) -> SocketOwner:
        """As which owner a client of this identity has its socket."""
        if self._is_open:
            identity = OPERATOR
        return owner_of(identity, self._gate.player(identity) is not None, address)

    def received(self, client: Client, data: str | bytes) -> None:
        """A WebSocket message from a client."""
        before, commands, now = client.identity, self._drivers.commands, self._loop.time()
        self._perform(client, client.receive(data, now))
        if self._drivers.commands != commands:
            self._delays.add(time.monotonic() - now)  # uvloop's clock stands still within a turn
        if client.identity is not before:
            self._move(client)

    def disconnected(self, client: Client) -> None:
        del self._connections[client]
        self._perform(client, client.closed())
        for task in [task for task, caller in self._calls.items() if caller is client]:
            self._loop.call_later(LAST_CALL, task.cancel)

    def stop(self) -> None:
        """The end: no robot keeps moving."""
        self._perform(None, self._drivers.stop_all())
        for task in self._tasks:
            task.cancel()
        self.outside.close()

    def metrics(self) -> Iterable[Metric]:
        """For those who watch rosbridge."""
        return metrics(len(self._connections), self._gate, self._drivers, self._delays, self._loop.time())

    def missing(self) -> str:
        """Why nobody can drive, "" if the players of a battle can."""
        return missing(self._gate, self._loop.time())

    def _perform(self, client: Client | None, effects: Sequence[Effect]) -> None:
        """Carry out the effects in order; replies only for a client that is still there."""
        for effect in effects:
            self._performers[type(effect)](client, effect)

    def _send(self, client: Client | None, effect: Send) -> None:
        connection = self._connections.get(client) if client else None
        if connection:
            connection.reply(effect.data, *effect.rest)

    def _hold(
        self,
        work: Callable[[Client, Any], Coroutine[Any, Any, Sequence[Effect]]],
        client: Client | None,
        effect: Effect,
    ) -> None:
        """What the client has sent since waits for that work, and for its effects."""
        if client in self._connections:
            self._connections[client].hold()
            self._start(self._held(client, work(client, effect)))

    async def _held(self, client: Client, work: Coroutine[Any, Any, Sequence[Effect]]) -> None:
        effects: Sequence[Effect] = []
        try:
            effects = await work
            if client in self._connections:  # what one that has gone opened now, nobody would close
                effects = [*effects, *self._rest(client, effects)]
                self._perform(client, effects)
                self._move(client)
        finally:
            connection = self._connections.get(client)
            if connection is not None and not any(isinstance(effect, _HOLDING) for effect in effects):
                connection.release()

    def _rest(self, client: Client, effects: Sequence[Effect]) -> Sequence[Effect]:
        return [] if any(isinstance(effect, _HOLDING) for effect in effects) else client.go_on(self._loop.time())

    async def _unpack(self, client: Client, effect: Unpack) -> Sequence[Effect]:
        fields, reason = {}, ""
        try:
            fields = await self.outside.do(unpacked, effect.text, effect.wrapper, *self._known(client))
        except (RequestError, RuntimeError) as error:
            reason = str(error)
        return self._handle(client, fields, reason)

    async def _read(self, client: Client, effect: Read) -> Sequence[Effect]:
        try:
            client.take(*await self.outside.do(read, client.stream, effect.data, *self._known(client)))
        except (RequestError, RuntimeError) as error:
            return client.report("error", str(error), self._loop.time())
        return []

    async def _go_on(self, _client: Client, _effect: GoOn) -> Sequence[Effect]:
        await asyncio.sleep(0)
        return []

    def _known(self, client: Client) -> tuple[dict[str, str], dict[str, str], int]:
        """What it takes to read a request: types of topics, of responses, ROS's time (ns)."""
        return self._graph.types(), client.owed(), self._clock.nanoseconds()

    def _handle(self, client: Client, fields: dict[str, Any], reason: str) -> list[Effect]:
        """The request with these fields, or why there is none."""
        now = self._loop.time()
        try:
            return client.report("error", reason, now) if reason else client.handle(Request(fields), now)
        except RequestError as error:
            return client.report("error", str(error), now)

    def _log(self, client: Client | None, effect: Log) -> None:
        connection = self._connections.get(client) if client else None
        if connection:
            connection.log(one_line(effect.text), effect.level)
        else:
            _log.log(effect.level, "a client: %s", one_line(effect.text))

    def _start(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        task = self._loop.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    def _later(self, client: Client | None, effect: Later) -> None:
        self._loop.call_later(LATER, lambda: self._perform(client, effect.due(self._loop.time())))

    # ---- services, and questions to the master ----

    async def _find_type(self, client: Client | None, wanted: FindType) -> None:
        self._perform(client, wanted.done(await self._ros.type_of(wanted.topic), self._loop.time()))

    def _start_call(self, client: Client | None, call: CallService) -> None:
        task = self._start(self._call(client, call))
        self._calls[task] = client
        task.add_done_callback(self._calls.pop)

    async def _call(self, client: Client | None, call: CallService) -> None:
        messages: Sequence[str | bytes] = []
        reason = ""
        try:
            messages = await self._replied(call, await self._ros.call(call))
        except RequestError as error:
            reason = str(error)
        except Exception:  # whatever it was, the client hears of the end, and its call counts no longer as under way
            _log.exception("the call of %s failed", call.service)
            reason = "the call failed"
        if client in self._connections:
            self._perform(client, call.done(messages, reason, self._loop.time()))

    async def _replied(self, call: CallService, response: Response) -> Sequence[str | bytes]:
        """What the client gets."""
        if takes_long(*response, call.reply.compression):
            data = PickleBuffer(response.data)  # which is not copied
            return [Framed(await self.outside.make(replied_frames, call.reply, response.type, data))]
        return replied(call.reply, response)

    def _open_service(self, client: Client | None, effect: OpenService) -> None:
        assert client is not None
        self._ros.open_service(effect.service, effect.type, partial(self._offered.ask, client, effect.service))

    async def _ask(self, client: Client | None, effect: Ask) -> None:
        try:
            frames = await self.outside.make(asked_frames, effect.operation, effect.type, PickleBuffer(effect.data))
        except (ConversionError, RuntimeError) as error:
            self._offered.answer(Answer(effect.call, None, str(error)))
        else:
            self._send(client, Send(Framed(frames)))

    def _close_service(self, _: Client | None, effect: CloseService) -> None:
        self._ros.close_service(effect.service)
        self._offered.fail(effect.service)

    # ---- from ROS to clients ----

    def _open_subscription(self, client: Client | None, topic: str, message_type: MessageType) -> None:
        self._ros.open_subscription(topic, message_type)
        self._start(self._settle(client, topic))

    async def _settle(self, client: Client | None, topic: str) -> None:
        """Tell the client when messages of the topic reach it."""
        if client is not None:
            await self._ros.settled(topic)
            self._perform(client, client.settled(topic, self._loop.time()))

    def _replay(self, client: Client | None, topic: str) -> None:
        message_type = self._graph.type_of(topic)
        if message_type is None:
            return  # these were the last words of a client that is gone: what closes the topic follows at once
        self._start(self._settle(client, topic))
        if client is not None:
            for trouble in self._ros.troubles(topic):
                self._perform(client, client.tell("error", trouble))
        for data in self._ros.latched(topic):
            told = self._gate.public(data) if topic == GAME_STATUS else data
            message = self._latest
            if message is None or not message.is_of(told):
                message = Delivery(message_type, told, self._clock.nanoseconds())
            self._offer([each for each in self._graph.subscriptions(topic) if each.client is client], topic, message)

    def _troubled(self, topic: str, trouble: str) -> None:
        """A publisher cannot be reached: those who are subscribed wait for what does not come."""
        waiting = {each.client for each in self._graph.subscriptions(topic)}
        for client in [each for each in self._connections if each in waiting]:
            self._perform(client, client.tell("error", trouble))

    def _deliver(self, topic: str, message_type: MessageType, data: bytes) -> None:
        """A message from ROS. It is encoded once in each form, however many clients get it."""
        if topic == GAME_STATUS:
            try:
                data = self._hear_referee(data)
            except genpy.DeserializationError as error:
                _log.warning("what the referee says cannot be read: %s", error)
                return
        message = Delivery(message_type, data, self._clock.nanoseconds())
        self._offer([each for each in self._graph.subscriptions(topic) if each.client is not GATE], topic, message)

    def _hear_referee(self, data: bytes) -> bytes:
        """The state of the battle, for the gate; what clients may know of it."""
        self._gate.update(GameStatus().deserialize(data), self._loop.time())
        self._check_rights()
        return self._gate.public(data)

    def _offer(self, subscriptions: list[Subscription], topic: str, message: Delivery) -> None:
        now = self._loop.time()
        self._pass([each for each in subscriptions if each.offer(message, now) is not None], topic, message)
        for subscription in subscriptions:
            self._wait(subscription, topic)

    def _release(self, subscription: Subscription, topic: str) -> None:
        """A throttled message is due."""
        del self._timers[subscription]
        message = subscription.release(self._loop.time())
        if message is not None:
            self._pass([subscription], topic, message)
        self._wait(subscription, topic)

    def _wait(self, subscription: Subscription, topic: str) -> None:
        """Set a timer for what is throttled."""
        if subscription.due is not None and subscription not in self._timers:
            self._timers[subscription] = self._loop.call_at(subscription.due, self._release, subscription, topic)

    def _pass(self, subscriptions: list[Subscription], topic: str, message: Delivery) -> None:
        """Send it, after those of the topic that wait, and at once only if it is not large."""
        queue = self._queues.get(topic)
        if queue is None:
            if not any(message.takes_long(each.form) for each in subscriptions):
                self._send_to(subscriptions, topic, message)
                return
            queue = self._queues[topic] = TopicQueue()
            self._start(self._encode(topic, queue))
        queue.put(message, subscriptions)

    async def _encode(self, topic: str, queue: TopicQueue) -> None:
        """Send what waits, in its order."""
        while queue:
            message, subscriptions = queue.next()
            try:
                while long := {each.form for each in subscriptions if message.takes_long(each.form)}:
                    for form in long:
                        message.take(form, await self.outside.make(Delivery.frames, message, form))
                    self._latest = message
            except (ConversionError, RuntimeError) as error:
                _log.warning("a message of %s cannot be sent: %s", topic, error)
            else:
                self._send_to([each for each in subscriptions if not each.has_ended], topic, message)
        del self._queues[topic]

    def _send_to(self, subscriptions: Iterable[Subscription], topic: str, message: Delivery) -> None:
        for subscription in subscriptions:
            connection = self._connections.get(subscription.client)  # type: ignore[call-overload]
            if connection is None:
                continue
            try:
                frames = message.frames(subscription.form)
            except ConversionError as error:  # a publisher whose messages are not of its type
                _log.warning("a message of %s cannot be read: %s", topic, error)
                return
            # of the game's own topics only the newest is worth sending
            connection.message(topic, frames, 1 if topic in OWN_TYPES else subscription.queue_length)

    # ---- rights ----

    def _tick(self) -> None:
        self._loop.call_later(TICK, self._tick)
        self._check_rights()
        # a throttled subscription may be long gone when its message would be due
        for subscription in [each for each in self._timers if each.due is None]:
            self._timers.pop(subscription).cancel()

    def _move(self, client: Client) -> None:
        """The client may be somebody else now, for whom other limits hold."""
        connection = self._connections.get(client)
        if connection is not None:
            connection.move(self.owner(client.identity, client.address))

    def _check_rights(self) -> None:
        """Stop the robots of those who may no longer drive, and tell the clients that the battle may have changed."""
        now = self._loop.time()
        stops = self._drivers.stop_refused(self._gate, now)
        for stop in stops:
            _log.info("%s is stopped: its driver may no longer drive", stop.topic)
        self._perform(None, stops)
        for client in list(self._connections):
            self._perform(client, client.updated(now))
            self._move(client)
