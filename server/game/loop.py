"""The one owner of the game's state: the referee behind a lock, with a clock, and a thread that tells listeners."""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from laser_bot_battle.floor import Zone
from server.game.departures import Departures
from server.game.events import Recorded, kind_of
from server.game.referee import Referee, Verdict, Wish
from server.game.sight import Moment, Pose, Wall
from server.game.snapshot import Player, Snapshot, Waiter

_log = logging.getLogger(__name__)

_HEARTBEAT = 0.4  # s; listeners hear at least every 0.5 s, also on a busy machine
# The thread looks at the clock at every heartbeat. When it has not for so much longer, the whole process stood still.
_STALL = 1.0  # s

Listener = Callable[[Snapshot], None]
Recorder = Callable[[Sequence[Recorded], Mapping[str, Any]], None]


class GameLoop:
    """Thread-safe. Events may come from any thread; they get the referee's answer at once.

    Listeners are called from one thread of its own, without the lock, with every changed snapshot in order,
    and with an unchanged one when nothing has happened for `_HEARTBEAT` seconds.
    """

    def __init__(self, referee: Referee, clock: Callable[[], float] = time.monotonic) -> None:
        self._referee = referee
        self._clock = clock
        self._changed = threading.Condition()
        self._looked_at = clock()
        self._latest = referee.snapshot(self._looked_at)
        self._undelivered: deque[Snapshot] = deque(maxlen=100)
        self._departures = Departures()
        self._listeners: list[Listener] = []
        self._recorders: list[Recorder] = []
        self._stopping = False
        self._thread = threading.Thread(target=self._run, name="game loop", daemon=True)

    def add_listener(self, listener: Listener) -> None:
        """To be called before `start`."""
        self._listeners.append(listener)

    def add_recorder(self, recorder: Recorder) -> None:
        """To be called before `start`. It gets all that is decided, in order, with the state after it in JSON's types;
        from the thread of the listeners, after them: what it sets going would keep them waiting."""
        self._recorders.append(recorder)

    def start(self) -> None:
        self._looked_at = self._clock()
        self._thread.start()

    def stop(self) -> None:
        """End the thread; listeners are not called any more."""
        with self._changed:
            self._stopping = True
            self._changed.notify()
        if self._thread.is_alive():
            self._thread.join()

    # events, see the referee

    def add_robot(self, caller: str, *, key: str = "", address: str = "") -> int | None:
        with self._event() as now:
            return self._referee.add_robot(caller, now, key=key, address=address)

    def robot_alive(self, robot_id: int, *, key: str = "", address: str = "", leaving: bool = False) -> Verdict:
        """`leaving`: it is the robot's last ping before it is switched off."""
        with self._event() as now:
            verdict = self._referee.robot_alive(robot_id, now, key=key, address=address)
            if verdict is Verdict.OK:
                self._departures.pinged(robot_id, leaving=leaving, now=now)
            return verdict

    def robots_left(self) -> set[int]:
        """Those that were switched off in order of late."""
        with self._changed:
            return self._departures.of_late(self._clock())

    def robots_linked(self, linked: Collection[int]) -> None:
        with self._event() as now:
            self._referee.robots_linked(linked, now)

    def restarting(self, robot_name: str, address: str, *, is_local: bool = False) -> float:
        with self._event() as now:
            return self._referee.restarting(robot_name, address, now, is_local=is_local)

    def shot(self, robot_id: int) -> bool:
        with self._event() as now:
            return self._referee.shot(robot_id, now)

    def hit(self, robot_id: int, *, shots_told: bool = False) -> bool:
        with self._event() as now:
            return self._referee.hit(robot_id, now, shots_told=shots_told)

    def shot_hit(self, robot_id: int, shooter: int, code: int, *, shots_told: bool = False) -> bool:
        with self._event() as now:
            return self._referee.shot_hit(robot_id, shooter, code, now, shots_told=shots_told)

    def see(self, walls: Sequence[Wall], poses: Mapping[int, Pose], size: tuple[float, float]) -> None:
        """Where the robots are, on a floor of that width and height (m)."""
        with self._event() as now:
            self._referee.see(Moment(now, tuple(walls), dict(poses)), size)

    def sign_up(
        self,
        name: str,
        session: str,
        avatar: int,
        *,
        old_session: str | None = None,
        wanted: int | None = None,
        wait: bool = False,
        address: str = "",
    ) -> tuple[Verdict, Player | Waiter | None]:
        with self._event() as now:
            return self._referee.sign_up(
                name, session, avatar, now, old_session=old_session, wanted=wanted, wait=wait, address=address
            )

    def take_offer(self, session: str) -> tuple[Verdict, Player | None]:
        with self._event() as now:
            return self._referee.take_offer(session, now)

    def sign_out(self, name: str, session: str) -> Verdict:
        with self._event() as now:
            return self._referee.sign_out(name, session, now)

    def set_ready(self, name: str, ready: bool, session: str) -> Verdict:
        with self._event() as now:
            return self._referee.set_ready(name, ready, session, now)

    def choose_team(self, name: str, team: int, session: str) -> Verdict:
        with self._event() as now:
            return self._referee.choose_team(name, team, session, now)

    def seen(self, session: str) -> Player | Waiter | None:
        with self._event() as now:
            return self._referee.seen(session, now)

    def operate(self, wish: Wish) -> None:
        with self._event() as now:
            self._referee.operate(wish, now)

    def lay_out(self, zones: Sequence[Zone], by: str) -> None:
        with self._event() as now:
            self._referee.lay_out(zones, by, now)

    def take_over(self, saved: Mapping[str, Any], known_robots: Mapping[str, int]) -> None:
        with self._event() as now:
            self._referee.take_over(saved, known_robots, now)

    def bots(self) -> dict[int, str]:
        with self._changed:
            return self._referee.bots()

    def overview(self) -> dict[str, Any]:
        with self._changed:
            return self._referee.overview(self._now())

    def snapshot(self) -> Snapshot:
        with self._changed:
            return self._take_snapshot(self._now())

    @contextmanager
    def _event(self) -> Iterator[float]:
        with self._changed:
            now = self._now()
            yield now
            self._take_snapshot(now)

    def _now(self) -> float:
        """The time. After a stall of this process, what the others did meanwhile is still in the sockets' queues."""
        now = self._clock()
        gap = now - self._looked_at
        if self._thread.is_alive() and gap > _HEARTBEAT + _STALL:
            self._referee.extend_deadlines(gap, now)
        self._looked_at = now
        return now

    def _take_snapshot(self, now: float) -> Snapshot:
        previous, self._latest = self._latest, self._referee.snapshot(now)
        if self._latest != previous:
            self._undelivered.append(self._latest)
            self._changed.notify()
        return self._latest

    # the thread

    def _run(self) -> None:
        told_at = self._clock()
        while True:
            with self._changed:
                if not self._undelivered and not self._stopping:
                    self._changed.wait(self._seconds_until_next(told_at + _HEARTBEAT))
                if self._stopping:
                    return
                now = self._now()
                self._take_snapshot(now)
                snapshots = list(self._undelivered)
                self._undelivered.clear()
                if not snapshots and now - told_at >= _HEARTBEAT:
                    snapshots = [self._latest]
                journal = self._referee.take_journal()
                saved = self._referee.saved(now) if journal else {}
                battle = self._latest.battle
            for snapshot in snapshots:
                self._tell(snapshot)
                told_at = now
            for recorded in journal:
                about = {"event": kind_of(recorded.event), "battle": battle}
                if hasattr(recorded.event, "robot"):
                    about["robot"] = recorded.event.robot
                _log.info("%s", recorded.event, extra={"fields": about})
            if journal:
                self._record(journal, saved)

    def _seconds_until_next(self, heartbeat: float) -> float:
        deadline = self._referee.next_deadline()
        return max(0.0, min(heartbeat, deadline if deadline is not None else heartbeat) - self._clock())

    def _record(self, journal: Sequence[Recorded], saved: Mapping[str, Any]) -> None:
        for recorder in self._recorders:
            try:
                recorder(journal, saved)
            except Exception:
                _log.exception("a recorder of the game failed")

    def _tell(self, snapshot: Snapshot) -> None:
        for listener in self._listeners:
            try:
                listener(snapshot)
            except Exception:
                _log.exception("a listener of the game failed; the others are told")
