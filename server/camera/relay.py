"""All cameras and all who look through them. For the event loop's thread."""

import asyncio
import logging
import time
from collections.abc import Callable, Iterable, Mapping
from functools import partial

import genpy
from prometheus_client.core import Metric
from std_msgs.msg import String

from laser_bot_battle.master import MasterError
from laser_bot_battle.msg import GameStatus
from laser_bot_battle.names import ABOVE, GAME_STATUS, OVERHEAD_CAMERA, ROBOT_IDS, camera_parameter
from server.access.identity import MAX_SECRET, Claim, Identity
from server.camera.access import CameraAccess
from server.camera.budget import Budget, Meter
from server.camera.camera import WAITING, Camera
from server.camera.metrics import Traffic, metrics
from server.camera.multipart import StreamError
from server.camera.picture import Picture
from server.camera.stream import Address, address_of, stream_of
from server.camera.viewer import Viewer
from server.websocket.connection import Connection
from server.websocket.frames import frame
from server.websocket.limits import Limits, SocketOwner, owner_of
from server.websocket.requests import Request, RequestError, brief, dumps, parse, status
from tcpros.node import Node
from tcpros.specs import TypeSpec

_log = logging.getLogger(__name__)

REFUSED = "refused"
TICK = 0.5  # s between two looks at rates, and at those who have not proven who they are
# Reloading the page finds the camera as it was, and flipping through all of them connects to each once a second.
LINGER = 1.0  # s
MEGABIT = 1e6 / 8  # bytes
SAME_TIME = 0.001  # s; a picture sent to many at once is the same for all


def limits_of(viewers: int) -> Limits:
    """Of so many, one address has half, and a fifth is kept for players and operators."""
    return Limits(clients=viewers, kept=viewers // 5, guests=max(1, viewers // 2))


class Relay:
    """Serves the WebSocket server."""

    def __init__(self, node: Node, access: CameraAccess, most_viewers: int, most_mbit: int) -> None:
        """`most_mbit` in Mbit/s. Needs a running event loop."""
        self._loop = asyncio.get_running_loop()
        self._node, self._access, self._most_viewers, self._most_mbit = node, access, most_viewers, most_mbit
        self._connections: dict[Viewer, Connection] = {}
        self._cameras: dict[int, Camera] = {}
        self._budget = Budget(most_mbit * MEGABIT)
        self._sent = Meter(self._loop.time())  # bytes
        self._traffic = Traffic()
        self._waiting: dict[Viewer, None] = {}  # spectators, in the order of their turns, for the budget
        self._timer: asyncio.TimerHandle | None = None  # of the next turn
        self._message: tuple[Picture, float, bytes] | None = None  # the last one, and when it was made
        self._handlers: dict[str, Callable[[Viewer, Request], None]] = {
            "auth": self._auth,
            "watch": self._watch,
            "seen": self._seen,
            "figures": self._figures,
        }
        self._above = ""  # where the camera above the floor is, if there is one
        node.subscribe(GAME_STATUS, TypeSpec.of(GameStatus), self._hear_referee)
        node.subscribe(OVERHEAD_CAMERA, TypeSpec.of(String), self._hear_tracker)
        self._loop.call_later(TICK, self._tick)

    def metrics(self) -> Iterable[Metric]:
        """For those who watch the relay."""
        return metrics(len(self._connections), self._cameras.values(), self._traffic, time.time())

    def missing(self) -> str:
        """Why spectators and players see nothing, "" if they can."""
        return "" if self._access.is_known else "nothing heard from the referee"

    # ---- viewers ----

    def owner(self, identity: Identity, address: str) -> SocketOwner:
        return owner_of(identity, self._access.player(identity) is not None, address)

    def connected(self, connection: Connection, identity: Identity) -> Viewer:
        viewer = Viewer(identity, connection.address)
        self._connections[viewer] = connection
        return viewer

    def disconnected(self, viewer: Viewer) -> None:
        del self._connections[viewer]
        self._waiting.pop(viewer, None)
        self._turn(viewer, None)

    def received(self, viewer: Viewer, data: str | bytes) -> None:
        connection, request = self._connections[viewer], None
        try:
            request = Request(parse(data))
            op = request.text("op")
            if op not in self._handlers:
                raise RequestError(f"the operation {brief(op)} is unknown here")
            self._handlers[op](viewer, request)
        except RequestError as error:
            connection.log(str(error))
            connection.reply(status("error", str(error), request.id if request else None))

    def _auth(self, viewer: Viewer, request: Request) -> None:
        name = request.optional_text("client", "operator")
        viewer.claim = Claim(name, request.text("mac", MAX_SECRET), self._loop.time(), request.id)
        self._check(viewer)

    def _watch(self, viewer: Viewer, request: Request) -> None:
        robot = request.fields.get("robot")
        if robot is not None and (type(robot) is not int or (robot not in ROBOT_IDS and robot != ABOVE)):
            raise RequestError(f"the field 'robot' must be the ID of a robot, {ABOVE} or null, not {brief(robot)}")
        viewer.watch(robot)
        self._check(viewer)

    def _seen(self, viewer: Viewer, _: Request) -> None:
        viewer.seen()
        self._serve(viewer)

    def _figures(self, viewer: Viewer, _: Request) -> None:
        if not viewer.identity.operator:
            raise RequestError("only operators get the figures")
        now = self._loop.time()
        figures = {
            "op": "figures",
            "viewers": len(self._connections),
            "most_viewers": self._most_viewers,
            "mbit": round(self._sent.rate(now) / MEGABIT, 2),
            "most_mbit": self._most_mbit,
            "cameras": [camera.metrics(now) for _, camera in sorted(self._cameras.items())],
        }
        self._connections[viewer].reply(dumps(figures))

    # ---- who may look through which camera ----

    def _hear_referee(self, data: bytes, _: Mapping[str, str]) -> None:
        try:
            self._access.hear(GameStatus().deserialize(data))
        except genpy.DeserializationError as error:
            _log.warning("what the referee says cannot be read: %s", error)
            return
        for viewer in list(self._connections):
            self._check(viewer)

    def _tick(self) -> None:
        self._loop.call_later(TICK, self._tick)
        now = self._loop.time()
        self._sent.mark(now)
        for camera in self._cameras.values():
            camera.mark(now)
        for viewer in [viewer for viewer in self._connections if viewer.claim]:
            self._check(viewer)

    def _check(self, viewer: Viewer) -> None:
        """The battle, the wish or the identity may have changed."""
        if viewer.claim:
            self._judge(viewer, viewer.claim)
        self._connections[viewer].move(self.owner(viewer.identity, viewer.address))
        wish = viewer.wish
        if wish is None:
            self._turn(viewer, None)
        elif not self._access.is_known and not viewer.identity.operator:
            self._turn(viewer, None)
            self._tell(viewer, WAITING, "nothing has been heard from the referee yet")
        elif reason := self._access.refuses(viewer.identity, wish):
            self._turn(viewer, None)
            self._tell(viewer, REFUSED, reason)
        else:
            self._turn(viewer, wish)
            self._tell(viewer, self._cameras[wish].state, self._cameras[wish].reason)
            self._serve(viewer)

    def _judge(self, viewer: Viewer, claim: Claim) -> None:
        connection = self._connections[viewer]
        verdict = claim.judge(self._access, viewer.address, self._loop.time())
        if verdict.warning:
            connection.log(verdict.warning, logging.WARNING)
        if verdict.identity is not None:
            viewer.claim, viewer.identity = None, verdict.identity
        elif verdict.refusal:
            viewer.claim = None
            connection.log(verdict.refusal)
            connection.reply(status("error", verdict.refusal, claim.request))

    def _tell(self, viewer: Viewer, state: str, reason: str) -> None:
        if news := viewer.news(state, reason):
            self._connections[viewer].message("camera", frame(news), 1)

    def _turn(self, viewer: Viewer, robot: int | None) -> None:
        """The viewer looks through that camera, or through none."""
        if viewer.robot == robot:
            return
        if viewer.robot is not None:
            camera = self._cameras[viewer.robot]
            camera.viewers.remove(viewer)
            if not camera.viewers:
                self._loop.call_later(LINGER, self._close, camera)
        newest = None
        if robot is not None:
            if robot not in self._cameras:
                self._cameras[robot] = Camera(robot, partial(self._find, robot), self._pictured, self._changed)
            self._cameras[robot].add(viewer)
            newest = self._cameras[robot].picture
        viewer.turn(robot, newest, self._loop.time())

    # ---- where cameras are ----

    def _hear_tracker(self, data: bytes, _: Mapping[str, str]) -> None:
        try:
            self._above = String().deserialize(data).data
        except genpy.DeserializationError as error:
            _log.warning("what the tracker says cannot be read: %s", error)

    async def _find(self, robot: int) -> Address:
        """LookupError if there is no such camera, StreamError if its address cannot be told."""
        if robot == ABOVE:
            if not self._above:
                raise LookupError
            if address := stream_of(self._above):
                return address
            raise StreamError("the tracker tells a wrong address of its camera")
        try:
            return address_of(await self._node.master("getParam", camera_parameter(robot)))
        except MasterError:  # it is not set
            raise LookupError from None
        except OSError:
            raise StreamError("the ROS master does not tell where the camera is") from None

    # ---- pictures ----

    def _close(self, camera: Camera) -> None:
        if not camera.viewers and self._cameras.get(camera.robot) is camera:
            del self._cameras[camera.robot]
            camera.close()

    def _changed(self, camera: Camera) -> None:
        for viewer in camera.viewers:
            self._tell(viewer, camera.state, camera.reason)

    def _pictured(self, camera: Camera, picture: Picture) -> None:
        self._traffic.received += 1
        now = self._loop.time()
        for viewer in camera.viewers:
            viewer.offer(picture, now)
            self._serve(viewer)

    def _serve(self, viewer: Viewer) -> None:
        """Send the viewer what it may have now, or have it wait for its turn."""
        if viewer.robot is None or not viewer.is_hungry or self._connections[viewer].is_blocked:
            return
        if viewer.identity.operator or self._drives(viewer):
            self._send(viewer)
        elif viewer not in self._waiting:
            self._waiting[viewer] = None
            if self._timer is None:
                self._next_turns()

    def _drives(self, viewer: Viewer) -> bool:
        """Whether it is the player's own robot, and the one page that the player looks at it on: of several, each has
        its turn as a spectator's has."""
        robot = viewer.robot
        if robot is None or not self._access.is_own(viewer.identity, robot):
            return False
        return sum(other.identity == viewer.identity for other in self._cameras[robot].viewers) == 1

    def _next_turns(self) -> None:
        """Send to spectators until the budget is used up."""
        self._timer = None
        while self._waiting:
            wait = self._budget.wait(self._loop.time())
            if wait:
                self._timer = self._loop.call_later(wait, self._next_turns)
                return
            viewer = next(iter(self._waiting))
            del self._waiting[viewer]
            if viewer.is_hungry and not self._connections[viewer].is_blocked:
                self._send(viewer)

    def _send(self, viewer: Viewer) -> None:
        picture, now = viewer.take(), time.time()
        if self._message is None or self._message[0] is not picture or not 0 <= now - self._message[1] < SAME_TIME:
            self._message = picture, now, frame(picture.message(now))
        message = self._message[2]
        self._budget.spend(len(message), self._loop.time())
        self._sent.add(len(message))
        self._traffic.sent += 1
        self._traffic.sent_bytes += len(message)
        self._connections[viewer].message("picture", message, 1)
