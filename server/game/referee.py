"""The rules of the battle, as a pure state machine: events and the time in, state out.

It has no threads, no clock and no I/O. What it decides are events, and its state follows from them. `now` is always
monotonic seconds, never smaller than in an earlier call. Every call first applies the deadlines that have passed by
then, in their order, so that the outcome does not depend on how often `tick` is called.
"""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from enum import Enum, auto
from functools import partial
from operator import itemgetter
from typing import Any

from laser_bot_battle.floor import Zone
from laser_bot_battle.light_protocol import DAMAGES
from laser_bot_battle.names import Game, client_name, is_bot
from server.game import (
    changes,
    desk,
    events,
    place_events,
    seats,
    tournament_course,
    tournament_desk,
    tournament_events,
    views,
)
from server.game.bots import bots
from server.game.events import Event, Recorded
from server.game.handicap import damage_with
from server.game.overview import overview
from server.game.people import AGAIN, TIME_LIMIT
from server.game.persistence import save
from server.game.pickups import DOUBLE, SHIELD
from server.game.places import Places
from server.game.robot import Robot
from server.game.rules import Rules
from server.game.shooting import Shooting
from server.game.sight import Moment
from server.game.snapshot import Player, Snapshot, Waiter
from server.game.state import State
from server.game.teams import sides
from server.game.users import User, Waiting, contains_word, is_same_name

HOLD = 10.0  # s after the last word of somebody who is about to restart, for which no countdown begins
HOLD_AT_MOST = 60.0  # s after the end of its battle; what asks longer does not restart
FRESH = 0.1  # s that the seconds of seats and queue, and the counts of shots, may be old


class Verdict(Enum):
    """The referee's answer to a player's wish."""

    OK = auto()
    QUEUED = auto()
    NO_OFFER = auto()
    ROBOT_AWAY = auto()  # it is silent, and may come back
    NAME_TAKEN = auto()
    NAME_BANNED = auto()  # by an operator
    NAME_UNWANTED = auto()  # contains a word of the operators' list
    NO_ROBOTS = auto()
    ROBOT_UNAVAILABLE = auto()  # the wanted one
    UNKNOWN_ROBOT = auto()
    UNKNOWN_USER = auto()
    NOT_YOURS = auto()  # the session is not that user's, or the key not that robot's
    NO_TEAM = auto()  # there are not so many
    STARTED = auto()  # not while a battle runs


# What an operator wants to be decided, see server.game.desk
Wish = Callable[[State, Rules], Iterable[Event]]


class Referee:
    """The one place where the state of the game changes."""

    def __init__(self, rules: Rules, state: State | None = None, zones: Sequence[Zone] = ()) -> None:
        """`state` is that of an earlier program, with which the game goes on; `zones` are the floor's."""
        self._configured = rules
        self._state = state or State()
        self._rules = replace(rules, **self._state.rules)
        self._journal: list[Recorded] = []
        self._shooting = Shooting()
        self._places = Places(zones)
        # Most calls are signs of life, which decide nothing: for them, these spare the way through robots and players.
        self._due = -math.inf  # no deadline passes before that
        self._at = -math.inf  # time of the last deadline or call
        self._latest: Snapshot | None = None  # as of some time since the last event
        self._latest_at = -math.inf
        self._uncounted = False  # shots have been fired since

    # robots

    def add_robot(self, caller: str, now: float, *, key: str = "", address: str = "") -> int | None:
        """A robot whose client has the ROS name `caller` registers; its ID, or None when there is none left.

        `key` is the digest of what its pings will show, "" if they show nothing: then they must come from `address`.
        """
        self.tick(now)
        robot_id, name = self._state.robots.id_for(caller)
        if robot_id is None:
            self._decide(events.RobotRefused(caller), now)
            return None
        self._decide(events.RobotCame(robot_id, name, key, address), now)
        self._settle_seats(now)
        return robot_id

    def robot_alive(self, robot_id: int, now: float, *, key: str = "", address: str = "") -> Verdict:
        """A ping of a robot, with what it shows: OK, UNKNOWN_ROBOT or NOT_YOURS."""
        self.tick(now)
        robot = self._state.robots.get_robot(robot_id)
        if robot is None:
            return Verdict.UNKNOWN_ROBOT
        if not robot.is_ping(key, address):
            return Verdict.NOT_YOURS
        robot.alive_at = now
        self._due = min(self._due, now + self._rules.robot_timeout)
        return Verdict.OK

    def robots_linked(self, linked: Collection[int], now: float) -> None:
        """Of the registered robots, the serial nodes of these are on their topics now, and no others."""
        self.tick(now)
        for robot in self._state.robots:
            if robot.linked != (robot.id in linked):
                self._decide(events.RobotLinked(robot.id, not robot.linked, robot.caller), now)
        self._settle_seats(now)

    def restarting(self, robot_name: str, address: str, now: float, *, is_local: bool = False) -> float:
        """Something is about to restart: that robot or, with "", the server. Returns how many s it had better wait for
        the end of its battle at most, and ask again each second; 0: not at all.

        Until it has ended, no countdown begins, and one that runs stops. But any visitor could ask: that is so only if
        a robot says it of itself, from the address by which it has registered, or a program on this machine. A robot
        may do so for a while, and then not before it has restarted, and registered again; the machine's programs once
        a battle.
        """
        self.tick(now)
        state, caller = self._state, client_name(robot_name)
        robot = next((robot for robot in state.robots if robot_name and robot.caller == caller), None)
        is_own_word = robot is not None and address != "" and robot.address == address
        if not (is_own_word or is_local):
            return state.time_left(now)
        if robot is None and robot_name:
            return 0.0
        fights = robot is None or any(user.robot == robot.id for user in state.users.get_users_ready())
        wait = max(1.0, state.time_left(now)) if state.game is Game.PLAYING and fights else 0.0
        holder = robot.id if robot else None
        held_until = min(now + HOLD, state.may_hold_until.setdefault(holder, now + wait + HOLD_AT_MOST))
        if held_until > now:
            if state.held is None:
                self._decide(events.Held(f"robot {robot.id}" if robot else "the server"), now)
                state.held_until = held_until
            state.held_until = max(state.held_until, held_until)
            self._due = min(self._due, state.held_until)
        return wait

    def shot(self, robot_id: int, now: float) -> bool:
        """A robot was told to shoot; whether that is a shot of a living fighter."""
        self.tick(now)
        shooter = self._fighter_on(robot_id)
        if shooter is None or not self._shooting.fire(robot_id, shooter, now):
            return False
        shooter.shots += 1
        self._uncounted = True
        return True

    def hit(self, robot_id: int, now: float, *, shots_told: bool = False) -> bool:
        """A robot's sensor has seen plain light; whether it has cost its player life.

        `shots_told`: each shot is told to the referee, so that light without one is none. Otherwise any light counts.
        """
        self.tick(now)
        robot, victim = self._state.robots.get_robot(robot_id), self._fighter_on(robot_id)
        if self._rules.is_coded or robot is None or victim is None or not robot.can_be_hit(now):
            return False
        by: str | None = ""
        if shots_told:
            by = self._shooting.plain_hit(robot_id, victim, self._rules.friendly_fire, now)
        if by is None or self._is_safe(victim, now):
            return False
        self._wound(victim, self._rules.hit_damage, by, now)
        return True

    def shot_hit(self, robot_id: int, shooter: int, code: int, now: float, *, shots_told: bool = False) -> bool:
        """A robot has received a coded shot of the robot `shooter`, with that code of damage; whether it has cost its
        player life. Without `shots_told`, the light itself is the news of the shot."""
        self.tick(now)
        victim = self._fighter_on(robot_id)
        if not self._rules.is_coded or victim is None:
            return False
        fighter = None if shots_told else self._fighter_on(shooter)
        if fighter is not None:
            self._shooting.fire(shooter, fighter, now)
        by = self._shooting.coded_hit(robot_id, victim, shooter, self._rules.friendly_fire, now)
        if by is None or self._is_safe(victim, now):
            return False
        if not self._places.may_have_met(shooter, robot_id, self._rules, now):
            self._decide(place_events.HitRefused(victim.name, robot_id, victim.life, by), now)
            return False
        damage = DAMAGES[code % len(DAMAGES)] if self._rules.light_damage else self._rules.hit_damage
        self._wound(victim, damage, by, now)
        return True

    def see(self, moment: Moment, size: tuple[float, float]) -> None:
        """Where the robots are, on a floor of that width and height (m)."""
        self.tick(moment.at)
        for event in self._places.see(moment, size, self._state, self._rules):
            self._decide(event, moment.at)

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
        wait: bool = False,
        address: str = "",
    ) -> tuple[Verdict, Player | Waiter | None]:
        """Claim the name and a robot together: the one with the ID `wanted`, or the lowest that is free.

        OK and the player. Without such a robot, or while others wait: with `wait` QUEUED and who is waiting now, else
        NO_ROBOTS or ROBOT_UNAVAILABLE. NAME_TAKEN, NAME_BANNED and NAME_UNWANTED go before both. Who signs up again
        with the session that the page has already (`old_session`) keeps everything; with another name, the old one is
        signed out, since the page has no use for it. `address` stands for the page's.
        """
        self.tick(now)
        known = self._named(name)
        if known is not None:
            if known.session != old_session:
                return Verdict.NAME_TAKEN, None
            return (Verdict.OK if isinstance(known, User) else Verdict.QUEUED), views.person(
                known, self._state, self._rules, now
            )
        if any(is_same_name(name, banned) for banned in self._state.banned):
            return Verdict.NAME_BANNED, None
        if any(contains_word(name, word) for word in self._state.words):
            return Verdict.NAME_UNWANTED, None
        wait = wait and not is_bot(name)
        robot = next(iter(seats.robots_for(name, self._state, self._rules, wanted)), None)
        if robot is None and not (wait and seats.has_room(self._state, address)):
            return (Verdict.NO_ROBOTS if wanted is None else Verdict.ROBOT_UNAVAILABLE), None
        old = self._of_session(old_session) if old_session else None  # before: the new one may have the same session
        if robot is None:
            self._decide(events.Queued(name, session, avatar, address), now)
        else:
            self._decide(events.SignedUp(name, robot.id, session, avatar, address), now)
        if old is not None:
            self._remove(old.name, f"{AGAIN}{name}", now)
        self._settle_seats(now)
        claimed = self._named(name)
        assert claimed is not None
        return (Verdict.OK if isinstance(claimed, User) else Verdict.QUEUED), views.person(
            claimed, self._state, self._rules, now
        )

    def take_offer(self, session: str, now: float) -> tuple[Verdict, Player | None]:
        """Take the robot that is offered: OK and the player, or NO_OFFER, UNKNOWN_USER."""
        self.tick(now)
        known = self._of_session(session)
        if known is None:
            return Verdict.UNKNOWN_USER, None
        if isinstance(known, Waiting):
            if known.offer is None:
                return Verdict.NO_OFFER, None
            self._decide(events.Seated(known.name), now)
        return Verdict.OK, views.player(self._state.users.user(known.name), self._state, self._rules, now)

    def sign_out(self, name: str, session: str, now: float) -> Verdict:
        """OK, UNKNOWN_USER or NOT_YOURS. Allowed at any time, also while waiting."""
        self.tick(now)
        known = self._named(name)
        if known is None:
            return Verdict.UNKNOWN_USER
        if known.session != session:
            return Verdict.NOT_YOURS
        self._remove(known.name, "signed out", now)
        return Verdict.OK

    def set_ready(self, name: str, ready: bool, session: str, now: float) -> Verdict:
        """OK, STARTED, UNKNOWN_USER, NOT_YOURS or ROBOT_AWAY. To say the same again changes nothing."""
        self.tick(now)
        user = self._named(name)
        if self._state.game is Game.PLAYING:
            return self._join(user, session, now) if ready else Verdict.STARTED
        if not isinstance(user, User):
            return Verdict.UNKNOWN_USER
        if user.session != session:
            return Verdict.NOT_YOURS
        if ready and user.robot_gone_at is not None:
            return Verdict.ROBOT_AWAY
        if ready and not self._state.may_fight(user.name):
            return Verdict.STARTED
        if user.ready != ready:
            self._decide(events.ReadyChanged(user.name, ready), now)
            self._settle(now, f"{user.name} is no longer ready")
        return Verdict.OK

    def choose_team(self, name: str, team: int, session: str, now: float) -> Verdict:
        """For the battles to come; 0: the referee deals it. OK, STARTED, UNKNOWN_USER, NOT_YOURS or NO_TEAM."""
        self.tick(now)
        if self._state.game is Game.PLAYING:
            return Verdict.STARTED
        user = self._named(name)
        if not isinstance(user, User):
            return Verdict.UNKNOWN_USER
        if user.session != session:
            return Verdict.NOT_YOURS
        if team not in range(self._rules.teams + 1):
            return Verdict.NO_TEAM
        if user.wish != team:
            self._decide(events.TeamChosen(user.name, team), now)
        return Verdict.OK

    def seen(self, session: str, now: float) -> Player | Waiter | None:
        """A sign of life of the page with that session; its player, or who waits on it; None if there is none."""
        self.tick(now)
        known = self._of_session(session)
        if known is None:
            return None
        known.seen = now
        self._due = min(self._due, now + self._rules.player_timeout, now + self._rules.seat_timeout)
        return views.person(known, self._state, self._rules, now)

    # operators

    def operate(self, wish: Wish, now: float) -> None:
        """Decide what an operator wants, all of it or, if it is refused, nothing."""
        self.tick(now)
        for event in tuple(wish(self._state, self._rules)):
            if isinstance(event, events.Left | events.Unseated):
                self._leave(event, now)
            else:
                self._decide(event, now)
        self._settle_seats(now)

    def lay_out(self, zones: Sequence[Zone], by: str, now: float) -> None:
        """The operator `by` has changed the floor: these are its zones. desk.RefusedError in a countdown or battle."""
        self.tick(now)
        if self._state.game is not Game.STOPPED:
            raise desk.RefusedError("the floor can be changed only while neither a countdown nor a battle runs")
        self._places = Places(zones)
        self._decide(events.FloorChanged(by), now)

    def take_over(self, saved: Mapping[str, Any], known_robots: Mapping[str, int], now: float) -> None:
        """What operators had decided in an earlier program (its `saved` state), and the IDs that robots had, come to
        light late: they hold again, unless something newer has been decided."""
        self._state.robots.remember(known_robots)
        self.operate(partial(desk.take_over, saved=saved), now)
        self.operate(lambda state, _: tournament_desk.take_over(state, saved.get("tournament") or {}), now)

    def bots(self) -> dict[int, str]:
        """The robots that are for bots, with the bots' levels."""
        return bots(self._state, self._rules)

    def overview(self, now: float) -> dict[str, Any]:
        """What operators see."""
        places_known = self._places.are_known(now)
        return overview(self._state, self._rules, self._configured, self.snapshot(now), now, places_known=places_known)

    # time

    def next_deadline(self) -> float | None:
        """When `tick` will next have something to do, if nothing happens before; None for never."""
        return min((at for at, _ in self._deadlines()), default=None)

    def tick(self, now: float) -> None:
        """Apply every deadline that has passed, each at its own time; one that has come up too late, at once."""
        while self._due <= now:
            at, act = min(self._deadlines(), key=itemgetter(0), default=(math.inf, None))
            if act is None or at > now:
                self._due = at
            else:
                self._at = max(self._at, at)
                act(self._at)
        self._at = max(self._at, now)

    def _deadlines(self) -> Iterator[tuple[float, Callable[[float], None]]]:
        state = self._state
        if state.paused_at is not None:
            pass  # the clock stands
        elif state.game is Game.COUNTDOWN:
            yield state.ends_at, self._start_battle
        elif state.game is Game.PLAYING:
            yield state.ends_at, partial(self._end_battle, cause=TIME_LIMIT)
        if state.held is not None:
            yield state.held_until, partial(self._release, state.held)
        for at, decided in self._places.deadlines(state, self._rules):
            yield at, partial(self._decide, decided)
        if absence := tournament_course.no_show(state):
            yield absence[0], partial(self._decide_absence, absence[1])
        for robot in state.robots:
            missed_at = max(robot.alive_at + self._rules.robot_timeout, robot.spared_until)
            yield missed_at, partial(self._lose_robot, robot)
        for at, event in seats.deadlines(state, self._rules):
            yield at, partial(self._leave, event)

    def extend_deadlines(self, gap: float, now: float) -> None:
        """This program itself stood still for `gap` s: nobody's silence of that time counts."""
        self._decide(events.StoodStill(gap), now)

    # what outsiders may know

    def snapshot(self, now: float) -> Snapshot:
        self.tick(now)
        state = self._state
        is_old = (state.queue or self._uncounted) and now >= self._latest_at + FRESH
        if self._latest is None or is_old:
            self._latest, self._latest_at, self._uncounted = (
                views.snapshot(state, self._rules, self._places, now),
                now,
                False,
            )
        else:  # while nobody waits, no seat ends: time passes for the clock only
            self._latest = replace(self._latest, time_left=state.time_left(now), protection=state.protection_left(now))
        return self._latest

    def saved(self, now: float) -> dict[str, Any]:
        """The state in JSON's types, for `restored` in another program."""
        return save(self._state, now)

    def take_journal(self) -> list[Recorded]:
        """What was decided since the last call."""
        journal, self._journal = self._journal, []
        return journal

    # decisions

    def _settle(self, now: float, cause: str) -> None:
        """Follow a change of who is ready or alive; `cause` is what to tell people if something ends by it."""
        users = self._state.users
        ready = users.get_users_ready()
        if self._state.game is Game.STOPPED and len(ready) >= 2 and self._state.held is None:
            self._decide(events.CountdownStarted(self._rules.countdown), now)
        elif self._state.game is Game.COUNTDOWN and len(ready) < 2:
            self._decide(events.CountdownStopped(cause), now)
        elif self._state.game is Game.PLAYING and sides(users.get_users_alive()) < 2:
            self._end_battle(now, cause)

    def _release(self, held: events.Held, now: float) -> None:
        self._decide(events.Released(held.what), now)
        self._settle(now, "")

    def _start_battle(self, now: float) -> None:
        self._decide(self._state.next_battle(self._rules), now)

    def _end_battle(self, now: float, cause: str) -> None:
        ended = events.BattleEnded(self._state.battle, cause, self._state.ranking())
        self._decide(ended, now)
        for won in tournament_course.game_won(self._state, ended.battle, ended.result):
            self._decide(won, now)
        self._settle_seats(now)

    def _decide_absence(self, event: tournament_events.NoShow, now: float) -> None:
        self._decide(event, now)
        self._settle_seats(now)

    def _join(self, user: User | Waiting | None, session: str, now: float) -> Verdict:
        """Somebody wants to be in the battle that runs: OK or STARTED."""
        if not isinstance(user, User) or user.session != session or not self._state.may_join(user, self._rules):
            return Verdict.STARTED
        self._decide(self._state.join(user, self._rules), now)
        return Verdict.OK

    def _fighter_on(self, robot_id: int) -> User | None:
        """Who drives that robot, alive in a battle that runs."""
        robot = self._state.robots.get_robot(robot_id)
        user = self._state.users.get_user(robot.user) if robot and robot.user else None
        runs = self._state.game is Game.PLAYING and self._state.paused_at is None
        return user if runs and user is not None and user.is_fighting else None

    def _is_safe(self, victim: User, now: float) -> bool:
        """Whether no hit costs the victim life now. A shot has met its robot in any case: it does not again later."""
        return self._state.protection_left(now) > 0 or SHIELD in victim.effects

    def _wound(self, victim: User, damage: int, by: str, now: float) -> None:
        shooter = self._state.fighter(by) if by else None
        if shooter is not None and DOUBLE in shooter.effects:
            damage *= 2
        life = max(0, victim.life - damage_with(victim.handicap, damage))
        self._decide(events.Hit(victim.name, victim.robot, life, by), now)
        self._settle(now, f"{victim.name} was shot down")

    def _lose_robot(self, robot: Robot, now: float) -> None:
        self._decide(events.RobotGone(robot.id), now)
        self._settle(now, f"{robot.user} lost the robot")
        self._settle_seats(now)

    def _remove(self, name: str, how: str, now: float) -> None:
        self._leave(events.Left(name, how), now)

    def _leave(self, event: events.Left | events.Unseated | events.OfferMissed, now: float) -> None:
        self._decide(event, now)
        self._settle(now, f"{event.name} {event.how}")
        self._settle_seats(now)

    def _settle_seats(self, now: float) -> None:
        """Offer robots that nobody has, or that others have to give up, to those who wait."""
        while event := seats.next_event(self._state, self._rules):
            self._decide(event, now)
            if isinstance(event, events.Left):
                self._settle(now, f"{event.name} {event.how}")

    def _decide(self, event: Event, now: float) -> None:
        changes.apply(self._state, event, now)
        if isinstance(event, events.RulesChanged):
            self._rules = replace(self._configured, **self._state.rules)
        elif isinstance(event, events.BattleStarted | events.Paused | events.Resumed):
            self._places.begin()
        self._due, self._latest = -math.inf, None
        self._journal.append(Recorded(now, event))

    def _named(self, name: str) -> User | Waiting | None:
        everybody = [*self._state.users, *self._state.queue]
        return next((one for one in everybody if is_same_name(one.name, name)), None)

    def _of_session(self, session: str) -> User | Waiting | None:
        everybody = [*self._state.users, *self._state.queue]
        return next((one for one in everybody if one.session == session), None)
