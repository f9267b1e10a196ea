"""What each event changes in the state of the game: one function an event."""

from collections.abc import Iterable
from dataclasses import replace
from functools import singledispatch

from laser_bot_battle.names import Game, is_bot
from server.game import events, handicap, place_events, rivalry, tournament_course
from server.game.events import Event
from server.game.pickups import PickUps
from server.game.presets import Preset
from server.game.ranking import ranks
from server.game.sight import Sides
from server.game.snapshot import Happening, Placing
from server.game.state import MEASURED, TOLD, State
from server.game.teams import are_friends
from server.game.tournament_events import TournamentEvent
from server.game.users import User, Waiting, is_same_name


def apply(state: State, event: Event, at: float) -> None:
    """Make it so; `at` in monotonic seconds."""
    _change(event, state, at)


@singledispatch
def _change(_event: Event, _state: State, _at: float) -> None:
    """An event that changes nothing is for the log only."""


# ---- robots ----


@_change.register
def _robot_came(event: events.RobotCame, state: State, at: float) -> None:
    state.robots.put(event.robot, event.caller, at, event.key, event.address)
    state.may_hold_until.pop(event.robot, None)
    for user in state.users:
        if user.robot == event.robot:
            user.robot_gone_at = None
            _give(state, event.robot, user.name)


@_change.register
def _robot_linked(event: events.RobotLinked, state: State, _at: float) -> None:
    state.robots.link(event.robot, event.linked)
    if not event.linked:
        _withdraw(state, event.robot)


@_change.register
def _robot_gone(event: events.RobotGone, state: State, at: float) -> None:
    state.robots.del_robot(event.robot)
    for user in state.users:
        if user.robot == event.robot:
            user.robot_gone_at = at
            _leave_battle(state, user, at)
    _withdraw(state, event.robot)


@_change.register
def _service_changed(event: events.ServiceChanged, state: State, _at: float) -> None:
    state.robots.set_service(event.robot, event.in_service)
    if not event.in_service:
        _withdraw(state, event.robot)


@_change.register
def _bot_chosen(event: events.BotChosen, state: State, _at: float) -> None:
    state.bots[event.robot] = event.level


# ---- players ----


@_change.register
def _signed_up(event: events.SignedUp, state: State, at: float) -> None:
    user = User(event.name, event.robot, event.session, event.avatar, seen=at, idle_since=at, address=event.address)
    _seat(state, user, at)


@_change.register
def _queued(event: events.Queued, state: State, at: float) -> None:
    _queue(state, Waiting(event.name, event.session, event.avatar, seen=at, since=at, address=event.address))


@_change.register
def _offered(event: events.Offered, state: State, at: float) -> None:
    waiting = state.waiting(event.name)
    waiting.offer, waiting.offer_ends = event.robot, at + event.seconds
    _give(state, event.robot, waiting.name)


@_change.register
def _offer_missed(event: events.OfferMissed, state: State, _at: float) -> None:
    waiting = state.waiting(event.name)
    if waiting.offer is not None:
        _give(state, waiting.offer, None)
    waiting.offer, waiting.missed, waiting.first = None, True, False
    place = state.queue.index(waiting)
    state.queue.insert(place + 1, state.queue.pop(place))


@_change.register
def _seated(event: events.Seated, state: State, at: float) -> None:
    waiting = state.waiting(event.name)
    assert waiting.offer is not None, "a robot is taken only by whoever it was offered to"
    state.queue.remove(waiting)
    user = User(
        waiting.name,
        waiting.offer,
        waiting.session,
        waiting.avatar,
        seen=waiting.seen,
        idle_since=at,
        address=waiting.address,
    )
    _seat(state, user, at)


@_change.register
def _unseated(event: events.Unseated, state: State, at: float) -> None:
    user = state.users.user(event.name)
    _remove_user(state, user, at)
    if is_bot(user.name):
        return
    waiting = Waiting(
        user.name,
        user.session,
        user.avatar,
        seen=user.seen,
        since=at,
        first=event.first,
        passed_on=True,
        address=user.address,
    )
    _queue(state, waiting)


@_change.register
def _left(event: events.Left, state: State, at: float) -> None:
    state.winning, state.grudges = rivalry.forget(event.name, state.winning, state.grudges)
    user = state.users.get_user(event.name)
    if user is not None:
        _remove_user(state, user, at)
        return
    waiting = state.waiting(event.name)
    state.queue.remove(waiting)
    if waiting.offer is not None:
        _give(state, waiting.offer, None)


@_change.register
def _ready_changed(event: events.ReadyChanged, state: State, at: float) -> None:
    user = state.users.user(event.name)
    user.ready = event.ready
    if event.ready:
        user.ready_since = at
    else:  # time of being ready does not count, and a short one does not wipe out what was before
        idle_from = max(user.idle_since, min((one.since for one in state.queue), default=user.idle_since))
        user.idle_since = idle_from + at - max(user.ready_since, idle_from)
    if event.ready and state.game is Game.COUNTDOWN:
        user.revive()


@_change.register
def _team_chosen(event: events.TeamChosen, state: State, _at: float) -> None:
    state.users.user(event.name).wish = event.team


# ---- the battle ----


@_change.register
def _countdown_started(event: events.CountdownStarted, state: State, at: float) -> None:
    for user in state.users.get_users_ready():
        user.revive()
    state.game, state.ends_at, state.paused_at = Game.COUNTDOWN, at + event.seconds, None
    state.notice, state.result = "", ()


@_change.register
def _countdown_stopped(event: events.CountdownStopped, state: State, at: float) -> None:
    state.game, state.notice, state.paused_at = Game.STOPPED, event.notice, None
    for user in state.users.get_users_ready() if event.by else ():
        user.ready, user.idle_since = False, at


@_change.register
def _held(event: events.Held, state: State, at: float) -> None:
    state.held, state.held_at = event, at
    if state.game is Game.COUNTDOWN:  # whoever is ready stays so
        state.game, state.paused_at = Game.STOPPED, None


@_change.register
def _released(_event: events.Released, state: State, at: float) -> None:
    state.held = None
    state.tournament = tournament_course.release(state.tournament, state.held_at, at)


@_change.register
def _battle_started(event: events.BattleStarted, state: State, at: float) -> None:
    state.game, state.battle, state.ends_at, state.paused_at = Game.PLAYING, event.battle, at + event.seconds, None
    state.began_at, state.teams, state.happened, state.pickups = at, event.teams, (), PickUps()
    state.protected_until = at + event.protection
    state.may_hold_until.pop(None, None)
    fighters = {fighter.name: (fighter.team, fighter.handicap) for fighter in event.fighters}
    for user in state.users:
        user.enter_battle(*fighters.get(user.name, (0, 0)), at)
    _put_in_order(state)
    for waiting in state.queue:
        waiting.passed_on = False


@_change.register
def _joined(event: events.Joined, state: State, at: float) -> None:
    user = state.users.user(event.name)
    user.enter_battle(0, event.handicap, at)
    user.revive()
    user.life, user.ready, user.ready_since = event.life, True, at
    _put_in_order(state)


@_change.register
def _hit(event: events.Hit, state: State, at: float) -> None:
    user = state.users.user(event.name)
    user.wound(event.life, at)
    state.robots.note_hit(event.robot, at)
    shooter = state.fighter(event.by) if event.by else None
    streak, revenge = 0, False
    if shooter is not None and not are_friends(shooter, user):
        shooter.hits += 1
        if event.life == 0:
            shooter.kills += 1
            streak, revenge = shooter.kills, rivalry.is_revenge(state.grudges, event.name, event.by)
            state.grudges = rivalry.taken_out(state.grudges, event.name, event.by)
    _tell(state, Happening(state.happenings + 1, event.name, event.by, event.life, streak, revenge))
    _put_in_order(state)


@_change.register
def _hit_refused(event: place_events.HitRefused, state: State, _at: float) -> None:
    _tell(state, Happening(state.happenings + 1, event.name, event.by, event.life, refused=True))


@_change.register
def _fenced(event: place_events.Fenced, state: State, _at: float) -> None:
    state.users.user(event.name).fence = Sides(event.ahead, event.behind)


@_change.register
def _hill_held(event: place_events.HillHeld, state: State, _at: float) -> None:
    state.users.user(event.name).points = event.points
    _put_in_order(state)


@_change.register
def _pick_up_laid(event: place_events.PickUpLaid, state: State, _at: float) -> None:
    state.pickups.lay(event.zone, event.kind)


@_change.register
def _picked_up(event: place_events.PickedUp, state: State, at: float) -> None:
    state.pickups.take(event.zone, at)
    user = state.users.user(event.name)
    user.life = event.life
    if event.seconds:
        user.effects[event.kind] = at + event.seconds
    _put_in_order(state)


@_change.register
def _effect_ended(event: place_events.EffectEnded, state: State, _at: float) -> None:
    state.users.user(event.name).effects.pop(event.kind, None)


@_change.register
def _battle_ended(event: events.BattleEnded, state: State, at: float) -> None:
    _leave_out_pause(state, state.users, at)
    ended_at = at if state.paused_at is None else state.paused_at
    state.game, state.notice, state.paused_at = Game.STOPPED, f"Battle over: {event.cause}.", None
    if event.counts:
        state.lengths = (*state.lengths, ended_at - state.began_at)[-MEASURED:]
        state.losing = handicap.follow(state.losing, event.result)
        state.winning = rivalry.follow(state.winning, event.result)
    state.result = tuple(_completed(placing, state, at) for placing in event.result) if event.counts else ()
    state.leavers = []
    state.pickups.lying = {}
    for user in state.users:
        user.effects = {}
        user.battles += user.ready and event.counts
        user.ready, user.idle_since = False, at


def _completed(placing: Placing, state: State, at: float) -> Placing:
    fighter = state.fighter(placing.name)
    seconds = fighter.fought(at) if fighter else 0.0
    return replace(placing, seconds=seconds, wins=rivalry.wins(placing.name, state.winning))


@_change.register
def _tournament_goes_on(event: TournamentEvent, state: State, at: float) -> None:
    state.tournament = tournament_course.follow(state.tournament, event, at)


# ---- time and the operators ----


@_change.register
def _stood_still(event: events.StoodStill, state: State, _at: float) -> None:
    state.tournament = tournament_course.delay(state.tournament, event.seconds)
    for robot in state.robots:
        robot.alive_at += event.seconds
    for user in state.users:
        user.seen += event.seconds
        user.idle_since += event.seconds
        user.ready_since += event.seconds
        if user.robot_gone_at is not None:
            user.robot_gone_at += event.seconds
    for waiting in state.queue:
        waiting.seen += event.seconds
        waiting.since += event.seconds
        waiting.offer_ends += event.seconds


@_change.register
def _paused(_event: events.Paused, state: State, at: float) -> None:
    state.paused_at = at


@_change.register
def _resumed(_event: events.Resumed, state: State, at: float) -> None:
    _leave_out_pause(state, state.users, at)
    if state.paused_at is not None:
        state.began_at += at - state.paused_at
        state.pickups.leave_out(at - state.paused_at)
    state.ends_at, state.protected_until = at + state.time_left(at), at + state.protection_left(at)
    state.paused_at = None


@_change.register
def _time_added(event: events.TimeAdded, state: State, _at: float) -> None:
    state.ends_at += event.seconds


@_change.register
def _rules_changed(event: events.RulesChanged, state: State, _at: float) -> None:
    state.rules = {rule: value for rule, value in {**state.rules, **event.changes}.items() if value is not None}


@_change.register
def _preset_saved(event: events.PresetSaved, state: State, _at: float) -> None:
    others = (preset for preset in state.presets if preset.name != event.preset)
    state.presets = (*others, Preset(event.preset, event.rules))


@_change.register
def _preset_removed(event: events.PresetRemoved, state: State, _at: float) -> None:
    state.presets = tuple(preset for preset in state.presets if preset.name != event.preset)


@_change.register
def _name_banned(event: events.NameBanned, state: State, _at: float) -> None:
    state.banned.append(event.name)


@_change.register
def _name_unbanned(event: events.NameUnbanned, state: State, _at: float) -> None:
    state.banned = [banned for banned in state.banned if not is_same_name(banned, event.name)]


@_change.register
def _words_changed(event: events.WordsChanged, state: State, _at: float) -> None:
    state.words = event.words


@_change.register
def _message_shown(event: events.MessageShown, state: State, _at: float) -> None:
    state.message = event.text


# ---- what several of them do ----


def _tell(state: State, happening: Happening) -> None:
    state.happenings = happening.number
    happened = (*state.happened, happening)
    alike = [one for one in happened if one.refused == happening.refused]  # refused hits push out none that count
    state.happened = tuple(one for one in happened if one not in alike[:-TOLD])


def _give(state: State, robot_id: int, name: str | None) -> None:
    robot = state.robots.get_robot(robot_id)
    if robot is not None:
        robot.user = name


def _withdraw(state: State, robot_id: int) -> None:
    """The robot is offered to nobody any more."""
    for waiting in state.queue:
        if waiting.offer == robot_id:
            waiting.offer = None
            _give(state, robot_id, None)


def _seat(state: State, user: User, at: float) -> None:
    user.seated_at = at
    state.users.add_user(user)
    _give(state, user.robot, user.name)


def _queue(state: State, waiting: Waiting) -> None:
    firsts = sum(other.first for other in state.queue)
    state.queue.insert(firsts if waiting.first else len(state.queue), waiting)


def _remove_user(state: State, user: User, at: float) -> None:
    _leave_battle(state, user, at)
    state.users.del_user(user)
    _give(state, user.robot, None)


def _leave_battle(state: State, user: User, at: float) -> None:
    """Whoever is in a running battle is a quitter of it."""
    if state.game is Game.PLAYING and user.ready:
        _leave_out_pause(state, [user], at)
        state.leavers.append(replace(user, left_at=at))
    user.ready, user.idle_since, user.effects = False, at, {}
    if state.game is Game.PLAYING:
        _put_in_order(state)


def _leave_out_pause(state: State, users: Iterable[User], at: float) -> None:
    """The pause that ends for these users, if there is one, is no time in which they have fought."""
    for user in users:
        if state.paused_at is not None and user.is_fighting:
            user.fights_since += at - state.paused_at
            user.effects = {kind: until + at - state.paused_at for kind, until in user.effects.items()}


def _put_in_order(state: State) -> None:
    """It stays so after the battle: old pages read the winner from the list."""
    ranked = ranks([*state.users, *state.leavers])
    leavers = {id(user) for user in state.leavers}
    state.users.put_in_order(user for _, user in ranked if id(user) not in leavers)
