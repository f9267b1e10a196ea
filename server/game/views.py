"""What others may know of the state of the game: pure."""

from laser_bot_battle.names import Game
from server.game import seats
from server.game.handicap import handicap
from server.game.places import Places
from server.game.rules import Rules
from server.game.snapshot import Player, Snapshot, Waiter
from server.game.state import State
from server.game.users import User, Waiting


def snapshot(state: State, rules: Rules, places: Places, now: float) -> Snapshot:
    teams, _ = state.terms(rules)
    return Snapshot(
        game=state.game,
        time_left=state.time_left(now),
        protection=state.protection_left(now),
        battle=state.battle,
        notice=state.notice_now(),
        paused=state.paused_at is not None,
        message=state.message,
        free_robots=tuple(robot.id for robot in seats.free_robots(state, rules)),
        robots=tuple(robot.id for robot in state.robots),
        players=tuple(player(user, state, rules, now) for user in state.users),
        queue=tuple(_waiter(waiting, place, state, rules, now) for place, waiting in enumerate(state.queue, 1)),
        practice=rules.practice,
        practice_beside=rules.practice_beside,
        result=state.result,
        teams=state.teams if state.game is Game.PLAYING else teams,
        coded=rules.is_coded,
        hide_cameras=rules.hide_cameras,
        damage=rules.hit_damage,
        happened=state.happened,
        places=places.shown(state, rules),
        tournament=state.tournament.version if state.tournament and not state.tournament.closed else 0,
    )


def person(known: User | Waiting, state: State, rules: Rules, now: float) -> Player | Waiter:
    if isinstance(known, User):
        return player(known, state, rules, now)
    return _waiter(known, state.queue.index(known) + 1, state, rules, now)


def player(user: User, state: State, rules: Rules, now: float) -> Player:
    ends = seats.seat_ends(state, rules).get(user.name)
    seat_left = 0.0 if ends is None else max(0.1, ends - now)
    teams, spared = state.terms(rules)
    wish = user.wish if user.wish <= teams else 0
    is_playing = state.game is Game.PLAYING
    return Player(
        name=user.name,
        robot=user.robot,
        life=user.life,
        ready=user.ready,
        avatar=user.avatar,
        session=user.session,
        may_join=state.may_join(user, rules),
        fence=user.fence,
        team=user.team if is_playing else wish,
        handicap=user.handicap if is_playing else handicap(user.name, state.losing, spared),
        hits=user.hits,
        kills=user.kills,
        points=user.points,
        effects=tuple(sorted(user.effects)),
        shots=user.shots,
        seat_left=seat_left,
    )


def _waiter(waiting: Waiting, place: int, state: State, rules: Rules, now: float) -> Waiter:
    seconds = seats.estimate(place, state, rules) if waiting.offer is None else max(0.0, waiting.offer_ends - now)
    return Waiter(waiting.name, waiting.avatar, waiting.session, place, waiting.offer, seconds)
