"""Who gets a robot, and for how long, when there are more people than robots: pure rules over the state.

A robot that nobody has is offered to whoever has waited longest; who does not take it in time is behind the next one
then, and out the second time. While somebody waits, a seat is not for ever: a player who is not ready for a while loses
it to somebody who has waited as long, and so does, between battles, one who has played several in a row, or has had the
robot for as long as one may. They all then wait behind the others. An address that has a robot gets another one only
when nobody from elsewhere waits. Bots do not wait, and make room for people at once. Who is called to a match of a
tournament has a robot before everybody else, and keeps it until the match is decided.
"""

from collections.abc import Iterator
from math import inf
from operator import attrgetter
from statistics import fmean

from laser_bot_battle.names import Game, is_bot
from server.game import events
from server.game.events import Event
from server.game.robot import Robot
from server.game.rules import Rules
from server.game.state import State
from server.game.teams import sides
from server.game.users import User, Waiting

MAX_WAITING = 100
MAX_WAITING_AT_ADDRESS = 10
_PAUSE = 20.0  # s between battles, for estimates


def next_event(state: State, rules: Rules) -> Event | None:
    """What is to happen to seats and queue at once; to be asked again until it is nothing."""
    for called in state.queue:
        if called.offer is None and (own := _kept_robot(state, called.name)):
            patience = state.tournament.patience if state.tournament else 0.0
            return events.Offered(called.name, own.id, max(rules.offer, patience))
    waiting = _next_waiting(state)
    if waiting is None:
        return None
    robot = next(iter(free_robots(state, rules)), None)
    if robot is not None:
        return events.Offered(waiting.name, robot.id, rules.offer)
    bot = next(_bots_that_can_go(state), None)
    if bot is not None:
        return events.Left(bot.name, "makes room for a person")
    is_break = state.game is Game.STOPPED and rules.battles_in_row
    if is_break and any(one.offer is None and not one.passed_on for one in state.queue):
        for user in state.users:
            if user.battles >= rules.battles_in_row and state.kept_robot(user.name) is None:
                return events.Unseated(user.name, f"has played {user.battles} in a row, and others wait")
    return None


def has_room(state: State, address: str) -> bool:
    """Whether one more from that address may wait."""
    there = sum(waiting.address == address for waiting in state.queue) if address else 0
    return len(state.queue) < MAX_WAITING and there < MAX_WAITING_AT_ADDRESS


def free_robots(state: State, rules: Rules) -> list[Robot]:
    """Those that can be given to somebody, in the order of their IDs."""
    given = sum(1 for _ in state.users) + sum(waiting.offer is not None for waiting in state.queue)
    kept = {*state.tournament.called().values()} if state.tournament else set()
    if rules.seats and given >= rules.seats:
        return []
    return [robot for robot in state.robots.get_available_robots() if robot.id not in kept]


def robots_for(name: str, state: State, rules: Rules, wanted: int | None) -> list[Robot]:
    """Those that somebody who comes now can have, or of them the `wanted` one: nobody is passed by who waits already,
    except by whoever is called to a match."""
    own = _kept_robot(state, name)
    if own is not None:
        return [own]
    free = [] if state.queue else free_robots(state, rules)
    return [robot for robot in free if wanted in (None, robot.id)]


def _kept_robot(state: State, name: str) -> Robot | None:
    """The one that is kept for that player, if it can be given."""
    kept = state.kept_robot(name)
    robot = state.robots.get_robot(kept) if kept is not None else None
    return robot if robot is not None and robot.is_free else None


def deadlines(state: State, rules: Rules) -> Iterator[tuple[float, events.Left | events.Unseated | events.OfferMissed]]:
    """What happens, and when, to players and those who wait when nothing is heard of them."""
    for user in state.users:
        yield user.seen + _patience(user, state, rules), events.Left(user.name, "left the page")
        if user.robot_gone_at is not None:
            yield user.robot_gone_at + rules.robot_return, events.Left(user.name, "lost the robot")
    for name, ends in seat_ends(state, rules).items():
        yield ends, events.Unseated(name, f"was not ready for {rules.idle:g} s while others waited")
    if rules.seat_minutes:
        how = f"has had the robot for {rules.seat_minutes:g} min, and others wait"
        minutes = rules.seat_minutes * 60
        # who has just had a robot waits for as long as others may have theirs
        from_when = sorted(one.since + minutes if one.passed_on else -inf for one in state.queue if one.offer is None)
        for user, since in zip(_longest_seated(state), from_when, strict=False):
            yield max(user.seated_at + minutes, since), events.Unseated(user.name, how)
    strangers = _strangers(state)
    one_of_several = _one_of_several(state) if strangers else None
    if one_of_several is not None:
        how = "has one of several robots at one address, and others wait"
        yield min(strangers) + rules.idle, events.Unseated(one_of_several.name, how)
    for waiting in state.queue:
        yield waiting.seen + rules.seat_timeout, events.Left(waiting.name, "left the page")
        if waiting.offer is not None:
            missed = events.OfferMissed(waiting.name)
            # a match waits for its players until it is decided
            is_out = waiting.missed and state.kept_robot(waiting.name) is None
            yield waiting.offer_ends, events.Left(waiting.name, missed.how) if is_out else missed


def seat_ends(state: State, rules: Rules) -> dict[str, float]:
    """Which players lose their seats if nothing changes, and when: one for each person in the queue without an offer,
    of those who are not ready, the longest idle first, and of equal ones the last in the ranking."""
    if state.game is Game.PLAYING:
        return {}
    waiting = sorted(one.since for one in state.queue if one.offer is None)
    if not waiting:
        return {}
    idle = [user for user in reversed([*state.users]) if not user.ready and state.kept_robot(user.name) is None]
    idle.sort(key=attrgetter("idle_since"))
    pairs = zip(waiting, idle, strict=False)
    return {user.name: max(since, user.idle_since) + rules.idle for since, user in pairs}


def estimate(place: int, state: State, rules: Rules) -> float:
    """About how many seconds until there is a robot for the one at `place` of the queue (1 is the next)."""
    robots = max(1, sum(robot.in_service for robot in state.robots))
    if rules.seats:
        robots = min(robots, rules.seats)
    battle = fmean(state.lengths) if state.lengths else rules.battle_limit / 2
    turn = (rules.battles_in_row or 1) * (battle + rules.countdown + _PAUSE)
    return turn * place / robots


def _longest_seated(state: State) -> list[User]:
    """Whose seats may end by their minutes, the longest seated first, and of equal ones the last in the ranking. In a
    countdown or battle, nobody's."""
    if state.game is not Game.STOPPED:
        return []
    seated = [user for user in reversed([*state.users]) if state.kept_robot(user.name) is None]
    return sorted(seated, key=attrgetter("seated_at"))


def _bots_that_can_go(state: State) -> Iterator[User]:
    """Those with a robot that a person can have, the last in the ranking first. A battle does not end by it."""
    fighting = state.users.get_users_alive() if state.game is Game.PLAYING else []
    for user in reversed([*state.users]):
        robot = state.robots.get_robot(user.robot) if is_bot(user.name) else None
        if robot is None or not (robot.in_service and robot.linked) or state.kept_robot(user.name) is not None:
            continue
        if user not in fighting or sides([other for other in fighting if other is not user]) >= 2:
            yield user


def _served(state: State) -> set[str]:
    """The addresses that have a robot. Whose address is not known counts as from an address of its own."""
    served = {user.address for user in state.users}
    served |= {waiting.address for waiting in state.queue if waiting.offer is not None}
    return served - {""}


def _strangers(state: State) -> list[float]:
    """Since when those wait whose address has no robot."""
    served = _served(state)
    return [one.since for one in state.queue if one.offer is None and one.address not in served]


def _one_of_several(state: State) -> User | None:
    """A player of an address that has several robots. Whoever fights is left alone."""
    seated = [user.address for user in state.users]
    several = [
        user
        for user in state.users
        if user.address
        and seated.count(user.address) > 1
        and not (user.ready and state.game is Game.PLAYING)
        and state.kept_robot(user.name) is None
    ]
    return several[-1] if several else None


def _next_waiting(state: State) -> Waiting | None:
    """Who gets the next robot."""
    waiting = [waiting for waiting in state.queue if waiting.offer is None]
    served = _served(state)
    return next((one for one in waiting if one.first or one.address not in served), waiting[0] if waiting else None)


def _patience(user: User, state: State, rules: Rules) -> float:
    """How long the page may be silent: who fights must be there, others may have a phone that sleeps."""
    return rules.player_timeout if state.game is Game.PLAYING and user.ready else rules.seat_timeout
