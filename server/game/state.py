"""The state of the game, changed by events only. Whatever decides them stands in the referee."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from laser_bot_battle.names import Game
from server.game import events
from server.game.events import Event
from server.game.ranking import ranks
from server.game.robot import Robots
from server.game.snapshot import Happening, Placing
from server.game.teams import are_friends, deal
from server.game.users import User, Users, Waiting, is_same_name

TOLD = 8  # of what has happened in a battle, the newest


@dataclass
class State:
    """All times are monotonic seconds."""

    robots: Robots = field(default_factory=Robots)
    users: Users = field(default_factory=Users)
    game: Game = Game.STOPPED
    ends_at: float = 0.0  # of the countdown or the battle; while it is paused, as if it went on at once
    paused_at: float | None = None  # None: it is not
    battle: int = 0
    notice: str = ""
    queue: list[Waiting] = field(default_factory=list)  # for a robot, the next one first
    leavers: list[User] = field(default_factory=list)  # who was in the running battle and has gone
    result: tuple[Placing, ...] = ()
    teams: int = 0  # of the running or the last battle; 0: everybody fights alone
    happened: tuple[Happening, ...] = ()  # in it, at most `TOLD`
    happenings: int = 0  # in all battles so far
    # what operators have decided
    rules: Mapping[str, Any] = field(default_factory=dict)  # values instead of the environment's
    banned: list[str] = field(default_factory=list)  # names
    words: tuple[str, ...] = ()  # that names may not contain
    message: str = ""

    def apply(self, event: Event, at: float) -> None:
        """Make it so."""
        match event:
            case events.StoodStill(seconds):
                self._give_time(seconds)
            case events.RobotCame(robot, caller, key, address):
                self.robots.put(robot, caller, at, key, address)
                self._return_robot(robot)
            case events.RobotLinked(robot, linked):
                self.robots.link(robot, linked)
                if not linked:
                    self._withdraw(robot)
            case events.RobotGone(robot):
                self._remove_robot(robot, at)
            case events.SignedUp(name, robot, session, avatar, address):
                self._seat(User(name, robot, session, avatar, seen=at, idle_since=at, address=address))
            case events.Queued(name, session, avatar, address):
                self._queue(Waiting(name, session, avatar, seen=at, since=at, address=address))
            case events.Offered(name, robot, seconds):
                self._offer(self.waiting(name), robot, at + seconds)
            case events.Seated(name):
                self._take_seat(self.waiting(name), at)
            case events.Unseated(name):
                user = self.users.user(name)
                self._remove_user(user, at)
                waiting = Waiting(
                    name,
                    user.session,
                    user.avatar,
                    seen=user.seen,
                    since=at,
                    first=event.first,
                    passed_on=True,
                    address=user.address,
                )
                self._queue(waiting)
            case events.Left(name):
                self._remove(name, at)
            case _:
                self._apply_to_battle(event, at)

    def _apply_to_battle(self, event: Event, at: float) -> None:
        match event:
            case events.ReadyChanged(name, ready):
                self._set_ready(self.users.user(name), ready, at)
            case events.TeamChosen(name, team):
                self.users.user(name).wish = team
            case events.CountdownStarted(seconds):
                self._start_countdown(at + seconds)
            case events.CountdownStopped():
                self._stop_countdown(event, at)
            case events.BattleStarted():
                self._start_battle(event, at)
            case events.Hit():
                self._hit(event, at)
            case events.BattleEnded():
                self._end_battle(event, at)
            case _:
                self._apply_operators(event, at)

    def _apply_operators(self, event: Event, at: float) -> None:
        match event:
            case events.Paused():
                self.paused_at = at
            case events.Resumed():
                self.ends_at, self.paused_at = at + self.time_left(at), None
            case events.TimeAdded(seconds):
                self.ends_at += seconds
            case events.RulesChanged(changes):
                self.rules = {rule: value for rule, value in {**self.rules, **changes}.items() if value is not None}
            case events.ServiceChanged(robot, in_service):
                self._set_service(robot, in_service)
            case events.NameBanned(name):
                self.banned.append(name)
            case events.NameUnbanned(name):
                self.banned = [banned for banned in self.banned if not is_same_name(banned, name)]
            case events.WordsChanged(words):
                self.words = words
            case events.MessageShown(text):
                self.message = text

    def time_left(self, now: float) -> float:
        """Seconds to the battle, or to its time limit; 0 when neither runs."""
        if self.game is Game.STOPPED:
            return 0.0
        return max(0.0, self.ends_at - (now if self.paused_at is None else self.paused_at))

    def next_battle(self, seconds: float, teams: int, by: str = "") -> events.BattleStarted:
        """The start of a battle of all who are ready."""
        ready = self.users.get_users_ready()
        dealt = zip(ready, deal(ready, teams), strict=True)
        fighters = tuple(events.Fighter(user.name, user.robot, user.avatar, team) for user, team in dealt)
        return events.BattleStarted(self.battle + 1, seconds, fighters, by, teams)

    def fighter(self, name: str) -> User | None:
        """Who fights in the running battle under that name, or has fought in it and left."""
        return next((user for user in [*self.users.get_users_ready(), *self.leavers] if user.name == name), None)

    def ranking(self) -> tuple[Placing, ...]:
        """Of the running battle, best first; who stands equal shares the place, and the places after it stay empty."""
        ranked = ranks([*self.users.get_users_ready(), *self.leavers])
        standings = [rank.standing for rank, _ in ranked]
        return tuple(
            Placing(
                name=user.name,
                robot=user.robot,
                life=user.life,
                avatar=user.avatar,
                place=standings.index(rank.standing) + 1,
                left=user.left_at is not None,
                team=user.team,
                shots=user.shots,
                hits=user.hits,
                kills=user.kills,
            )
            for rank, user in ranked
        )

    def waiting(self, name: str) -> Waiting:
        """Who waits under that name. KeyError when nobody does."""
        found = next((waiting for waiting in self.queue if waiting.name == name), None)
        if found is None:
            raise KeyError(f"nobody waits as {name}")
        return found

    def _return_robot(self, robot_id: int) -> None:
        for user in self.users:
            if user.robot == robot_id:
                user.robot_gone_at = None
                self._give(robot_id, user.name)

    def _remove_robot(self, robot_id: int, at: float) -> None:
        self.robots.del_robot(robot_id)
        for user in self.users:
            if user.robot == robot_id:
                user.robot_gone_at = at
                self._leave_battle(user, at)
        self._withdraw(robot_id)

    def _set_service(self, robot_id: int, in_service: bool) -> None:
        self.robots.set_service(robot_id, in_service)
        if not in_service:
            self._withdraw(robot_id)

    def _withdraw(self, robot_id: int) -> None:
        """The robot is offered to nobody any more."""
        for waiting in self.queue:
            if waiting.offer == robot_id:
                waiting.offer = None
                self._give(robot_id, None)

    def _seat(self, user: User) -> None:
        self.users.add_user(user)
        self._give(user.robot, user.name)

    def _queue(self, waiting: Waiting) -> None:
        firsts = sum(other.first for other in self.queue)
        self.queue.insert(firsts if waiting.first else len(self.queue), waiting)

    def _offer(self, waiting: Waiting, robot_id: int, ends: float) -> None:
        waiting.offer, waiting.offer_ends = robot_id, ends
        self._give(robot_id, waiting.name)

    def _take_seat(self, waiting: Waiting, at: float) -> None:
        assert waiting.offer is not None, "only who has an offer takes it"
        self.queue.remove(waiting)
        self._seat(
            User(
                waiting.name,
                waiting.offer,
                waiting.session,
                waiting.avatar,
                seen=waiting.seen,
                idle_since=at,
                address=waiting.address,
            )
        )

    def _remove(self, name: str, at: float) -> None:
        user = self.users.get_user(name)
        if user is not None:
            self._remove_user(user, at)
            return
        waiting = self.waiting(name)
        self.queue.remove(waiting)
        if waiting.offer is not None:
            self._give(waiting.offer, None)

    def _remove_user(self, user: User, at: float) -> None:
        self._leave_battle(user, at)
        self.users.del_user(user)
        self._give(user.robot, None)

    def _give(self, robot_id: int, name: str | None) -> None:
        robot = self.robots.get_robot(robot_id)
        if robot is not None:
            robot.user = name

    def _leave_battle(self, user: User, at: float) -> None:
        """Whoever is in a running battle is a quitter of it."""
        if self.game is Game.PLAYING and user.ready:
            self.leavers.append(replace(user, left_at=at))
        user.ready, user.idle_since = False, at
        if self.game is Game.PLAYING:
            self._put_in_order()

    def _put_in_order(self) -> None:
        """It stays so after the battle: old pages read the winner from the list."""
        ranked = ranks([*self.users, *self.leavers])
        leavers = {id(user) for user in self.leavers}
        self.users.put_in_order(user for _, user in ranked if id(user) not in leavers)

    def _set_ready(self, user: User, ready: bool, at: float) -> None:
        user.ready = ready
        if ready:
            user.ready_since = at
        else:  # time of being ready does not count, and a short one does not wipe out what was before
            idle_from = max(user.idle_since, min((one.since for one in self.queue), default=user.idle_since))
            user.idle_since = idle_from + at - max(user.ready_since, idle_from)
        if ready and self.game is Game.COUNTDOWN:
            user.revive()

    def _start_countdown(self, ends_at: float) -> None:
        for user in self.users.get_users_ready():
            user.revive()
        self.game, self.ends_at, self.paused_at = Game.COUNTDOWN, ends_at, None
        self.notice, self.result = "", ()

    def _stop_countdown(self, event: events.CountdownStopped, at: float) -> None:
        self.game, self.notice, self.paused_at = Game.STOPPED, event.notice, None
        for user in self.users.get_users_ready() if event.by else ():
            user.ready, user.idle_since = False, at

    def _start_battle(self, event: events.BattleStarted, at: float) -> None:
        self.game, self.battle, self.ends_at, self.paused_at = Game.PLAYING, event.battle, at + event.seconds, None
        self.teams, self.happened = event.teams, ()
        teams = {fighter.name: fighter.team for fighter in event.fighters}
        for user in self.users:
            user.enter_battle(teams.get(user.name, 0))
        self._put_in_order()
        for waiting in self.queue:
            waiting.passed_on = False

    def _hit(self, event: events.Hit, at: float) -> None:
        user = self.users.user(event.name)
        user.wound(event.life, at)
        self.robots.note_hit(event.robot, at)
        shooter = self.fighter(event.by) if event.by else None
        if shooter is not None and not are_friends(shooter, user):
            shooter.hits += 1
            shooter.kills += event.life == 0
        self.happenings += 1
        self.happened = (*self.happened, Happening(self.happenings, event.name, event.by, event.life))[-TOLD:]
        self._put_in_order()

    def _end_battle(self, event: events.BattleEnded, at: float) -> None:
        self.game, self.notice, self.paused_at = Game.STOPPED, f"Battle over: {event.cause}.", None
        self.result = event.result if event.counts else ()
        self.leavers = []
        for user in self.users:
            user.battles += user.ready and event.counts
            user.ready, user.idle_since = False, at

    def _give_time(self, seconds: float) -> None:
        for robot in self.robots:
            robot.alive_at += seconds
        for user in self.users:
            user.seen += seconds
            user.idle_since += seconds
            user.ready_since += seconds
            if user.robot_gone_at is not None:
                user.robot_gone_at += seconds
        for waiting in self.queue:
            waiting.seen += seconds
            waiting.since += seconds
            waiting.offer_ends += seconds
