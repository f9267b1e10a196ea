"""The rules of the battle, as a pure state machine: events and the time in, state out.

It has no threads, no clock and no I/O. `now` is always monotonic seconds, never smaller than in an earlier call. Every
event first applies the deadlines that have passed by then, in their order, so that the outcome does not depend on how
often `tick` is called.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, auto
from functools import partial
from operator import itemgetter

from laser_bot_battle import variables
from laser_bot_battle.names import Game
from server.game.robot import Robot, Robots
from server.game.snapshot import Placing, Player, Snapshot
from server.game.users import User, Users


@dataclass(frozen=True)
class Rules:
    """The numbers of the game; times in seconds."""

    hit_damage: int = variables.HIT_DAMAGE.default
    countdown: float = variables.COUNTDOWN.default
    battle_limit: float = variables.BATTLE_LIMIT.default
    player_timeout: float = variables.PLAYER_TIMEOUT.default  # a page that is silent for so long has gone
    robot_timeout: float = 3.0  # within the 2 to 4 s of the manual's sweep


class Verdict(Enum):
    """The referee's answer to a player's wish."""

    OK = auto()
    NAME_TAKEN = auto()
    NO_ROBOTS = auto()
    ROBOT_UNAVAILABLE = auto()  # the wanted one
    UNKNOWN_USER = auto()
    NOT_YOURS = auto()  # the session is not that user's
    STARTED = auto()  # not while a battle runs


class Referee:
    """The one place where the state of the game changes."""

    def __init__(self, rules: Rules, known_robots: Mapping[str, int] | None = None) -> None:
        self._rules = rules
        self._robots = Robots(known_robots)
        self._users = Users()
        self._game = Game.STOPPED
        self._ends_at = 0.0  # of the countdown or the battle
        self._battle = 0
        self._notice = ""
        self._leavers: list[User] = []  # who was in the running battle and has gone
        self._result: tuple[Placing, ...] = ()
        self._journal: list[str] = []

    # robots

    def add_robot(self, caller: str, now: float) -> int | None:
        """A robot whose client has the ROS name `caller` registers; its ID, or None when there is none left."""
        self.tick(now)
        robot = self._robots.add_robot(caller, now)
        if robot is None:
            self._note("a robot was refused: all IDs are in use")
            return None
        self._note(f"robot {robot.id} registered by {robot.caller or 'an unnamed client'}")
        return robot.id

    def robot_alive(self, robot_id: int, now: float) -> bool:
        """A ping of a robot; False when it is not registered."""
        self.tick(now)
        robot = self._robots.get_robot(robot_id)
        if robot is None:
            return False
        robot.alive_at = now
        return True

    def hit(self, robot_id: int, now: float) -> bool:
        """A robot's sensor was hit; whether it has cost its player life."""
        self.tick(now)
        robot = self._robots.get_robot(robot_id)
        user = self._users.get_user(robot.user) if robot and robot.user else None
        if self._game is not Game.PLAYING or user is None or not user.is_fighting:
            return False
        user.hit(self._rules.hit_damage, now)
        self._note(f"{user.name} (robot {robot_id}) has been hit, life {user.life}")
        self._settle(now, f"{user.name} was shot down")
        return True

    @property
    def known_robots(self) -> dict[str, int]:
        """The ID of every named robot that has ever registered."""
        return self._robots.known

    # players

    def sign_up(
        self,
        name: str,
        session: str,
        avatar: int,
        now: float,
        *,
        old_session: str | None = None,
        wanted: int | None = None,
    ) -> tuple[Verdict, Player | None]:
        """Claim the name and a robot together: the one with the ID `wanted`, or the lowest that is free.

        OK and the player; or NAME_TAKEN, NO_ROBOTS, ROBOT_UNAVAILABLE. A user who signs up again with the session that
        the page has already (`old_session`) keeps everything; with another name, the old one is signed out, since the
        page forgets its session.
        """
        self.tick(now)
        user = self._users.get_user(name)
        if user is not None:
            if user.session != old_session:
                return Verdict.NAME_TAKEN, None
            return Verdict.OK, _player(user)
        robot = self._robots.get_available_robot(wanted)
        if robot is None:
            return (Verdict.NO_ROBOTS if wanted is None else Verdict.ROBOT_UNAVAILABLE), None
        user = User(name, robot.id, session, avatar, seen=now)
        self._users.add_user(user)
        robot.user = name
        self._note(f"{name} signed up and drives robot {robot.id}")
        old_user = self._users.get_session_user(old_session) if old_session else None
        if old_user is not None:
            self._remove_user(old_user, f"signed up again as {name}", now)
        return Verdict.OK, _player(user)

    def sign_out(self, name: str, session: str, now: float) -> Verdict:
        """OK, UNKNOWN_USER or NOT_YOURS. Allowed at any time."""
        self.tick(now)
        user = self._users.get_user(name)
        if user is None:
            return Verdict.UNKNOWN_USER
        if user.session != session:
            return Verdict.NOT_YOURS
        self._remove_user(user, "signed out", now)
        return Verdict.OK

    def set_ready(self, name: str, ready: bool, session: str, now: float) -> Verdict:
        """OK, STARTED, UNKNOWN_USER or NOT_YOURS. To say the same again changes nothing."""
        self.tick(now)
        if self._game is Game.PLAYING:
            return Verdict.STARTED
        user = self._users.get_user(name)
        if user is None:
            return Verdict.UNKNOWN_USER
        if user.session != session:
            return Verdict.NOT_YOURS
        if user.ready != ready:
            user.ready = ready
            if ready and self._game is Game.COUNTDOWN:
                user.revive()
            self._note(f"{name} is {'ready' if ready else 'no longer ready'}")
            self._settle(now, f"{name} is no longer ready")
        return Verdict.OK

    def seen(self, session: str, now: float) -> Player | None:
        """A sign of life of the page with that session; its player, None if there is none."""
        self.tick(now)
        user = self._users.get_session_user(session)
        if user is None:
            return None
        user.seen = now
        return _player(user)

    # time

    def next_deadline(self) -> float | None:
        """When `tick` will next have something to do, if nothing happens before; None for never."""
        return min((at for at, _ in self._deadlines()), default=None)

    def tick(self, now: float) -> None:
        """Apply every deadline that has passed, each at its own time."""
        while (due := min(self._deadlines(), key=itemgetter(0), default=None)) and due[0] <= now:
            at, act = due
            act(at)

    def _deadlines(self) -> Iterator[tuple[float, Callable[[float], None]]]:
        if self._game is Game.COUNTDOWN:
            yield self._ends_at, self._start_battle
        elif self._game is Game.PLAYING:
            yield self._ends_at, partial(self._end_battle, cause="the time limit is reached")
        for robot in self._robots:
            yield robot.alive_at + self._rules.robot_timeout, partial(self._remove_robot, robot)
        for user in self._users:
            yield user.seen + self._rules.player_timeout, partial(self._remove_user, user, "left the page")

    def extend_deadlines(self, gap: float) -> None:
        """This program itself stood still for `gap` s: nobody's silence of that time counts."""
        for robot in self._robots:
            robot.alive_at += gap
        for user in self._users:
            user.seen += gap
        self._note(f"the server stood still for {gap:.1f} s: robots and pages get that much more time")

    # what outsiders may know

    def snapshot(self, now: float) -> Snapshot:
        self.tick(now)
        return Snapshot(
            game=self._game,
            time_left=0.0 if self._game is Game.STOPPED else max(0.0, self._ends_at - now),
            battle=self._battle,
            notice=self._notice,
            available_robots=self._robots.get_available_robots_n(),
            robots=tuple(robot.id for robot in self._robots),
            players=tuple(_player(user) for user in self._users),
            result=self._result,
        )

    def take_journal(self) -> list[str]:
        """What has happened since the last call, one line each, for the log."""
        journal, self._journal = self._journal, []
        return journal

    # transitions

    def _settle(self, now: float, cause: str) -> None:
        """Follow a change of who is ready or alive; `cause` is what to tell people if something ends by it."""
        ready = self._users.get_users_ready()
        if self._game is Game.STOPPED and len(ready) >= 2:
            self._start_countdown(ready, now)
        elif self._game is Game.COUNTDOWN and len(ready) < 2:
            self._game = Game.STOPPED
            self._notice = f"Countdown stopped: {cause}, fewer than two players are ready."
            self._note(self._notice)
        elif self._game is Game.PLAYING:
            self._users.users_sort()  # stays so after the battle: old pages read the winner from the list
            if len(self._users.get_users_alive()) < 2:
                self._end_battle(now, cause)

    def _start_countdown(self, ready: list[User], now: float) -> None:
        for user in ready:
            user.revive()
        self._game = Game.COUNTDOWN
        self._ends_at = now + self._rules.countdown
        self._notice = ""
        self._result = ()
        self._note(f"countdown started: {self._rules.countdown:g} s")

    def _start_battle(self, now: float) -> None:
        self._game = Game.PLAYING
        self._ends_at = now + self._rules.battle_limit
        self._battle += 1
        self._users.users_sort()
        names = ", ".join(user.name for user in self._users.get_users_ready())
        self._note(f"battle {self._battle} started: {names}")

    def _end_battle(self, now: float, cause: str) -> None:
        self._result = _ranking([*self._users.get_users_ready(), *self._leavers])
        self._leavers = []
        self._users.clear_users_ready()
        self._game = Game.STOPPED
        self._notice = f"Battle over: {cause}."
        ranking = ", ".join(f"{placing.place} {placing.name}" for placing in self._result)
        self._note(f"battle {self._battle} over: {cause}; ranking: {ranking}")

    def _remove_robot(self, robot: Robot, now: float) -> None:
        self._robots.del_robot(robot)
        self._note(f"robot {robot.id} is gone")
        user = self._users.get_user(robot.user) if robot.user else None
        if user is not None:
            self._remove_user(user, "lost the robot", now)

    def _remove_user(self, user: User, how: str, now: float) -> None:
        self._users.del_user(user)
        robot = self._robots.get_robot(user.robot)
        if robot is not None and robot.user == user.name:
            robot.user = None
        if self._game is Game.PLAYING and user.ready:
            user.left_at = now
            self._leavers.append(user)
        self._note(f"{user.name} {how}")
        self._settle(now, f"{user.name} {how}")

    def _note(self, text: str) -> None:
        self._journal.append(text)


def _player(user: User) -> Player:
    return Player(user.name, user.robot, user.life, user.ready, user.avatar, user.session)


def _ranking(fighters: list[User]) -> tuple[Placing, ...]:
    """Best first; who stands equal shares the place, and the places after it stay empty."""
    ranked = sorted(fighters, key=lambda user: user.standing)
    standings = [user.standing for user in ranked]
    return tuple(
        Placing(
            name=user.name,
            robot=user.robot,
            life=user.life,
            avatar=user.avatar,
            place=standings.index(user.standing) + 1,
            left=user.left_at is not None,
        )
        for user in ranked
    )
