"""The state of the game as JSON, and back: how it outlives its program.

A monotonic clock may mean nothing to another program, so times are kept as seconds before or after the moment of
saving. How long ago that was is for others to know (server.store.clocks).
"""

from collections.abc import Mapping
from typing import Any

from laser_bot_battle.names import Game
from server.game import tournament_course
from server.game.handicap import Losing
from server.game.people import NEUTRAL
from server.game.pickups import PickUps
from server.game.presets import Preset
from server.game.rivalry import Grudge, Winning
from server.game.robot import Robot, Robots
from server.game.rules import DECLARED, checked
from server.game.snapshot import Happening, Placing
from server.game.state import State
from server.game.tournament import Tournament
from server.game.users import User, Users, Waiting

_Kept = Placing | Losing | Winning | Grudge | Happening  # kept by the names of its fields

# s in which no robot is missed: when the ROS master was restarted, too, as by an update of the whole master, the
# robots' own programs start again, some after a ping or two. That takes them 5 to 8 s, and the smallest ones twice as
# long.
ROBOTS_RETURN = 20.0


def save(state: State, now: float) -> dict[str, Any]:
    """`state` at the time `now`."""
    stands_at = now if state.paused_at is None else state.paused_at
    return {
        "game": state.game.value,
        "left": state.ends_at - stands_at,
        "protected": state.protected_until - stands_at,
        "paused": state.paused_at is not None,
        "paused_for": now - stands_at,
        "battle": state.battle,
        "began": state.began_at - now,
        "lengths": list(state.lengths),
        "notice": state.notice,
        "robots": [_save_robot(robot) for robot in state.robots],
        "users": [_save_user(user, now, stands_at) for user in state.users],
        "queue": [_save_waiting(waiting, now) for waiting in state.queue],
        "leavers": [_save_user(user, now, stands_at) for user in state.leavers],
        "result": [_fields(placing) for placing in state.result],
        "losing": [_fields(one) for one in state.losing],
        "winning": [_fields(one) for one in state.winning],
        "grudges": [_fields(one) for one in state.grudges],
        "teams": state.teams,
        "pickups": state.pickups.save(stands_at),
        "happened": [_fields(happening) for happening in state.happened],
        "happenings": state.happenings,
        "out_of_service": sorted(state.robots.out_of_service),
        "bots": {str(robot): level for robot, level in state.bots.items()},
        "rules": dict(state.rules),
        "presets": [{"name": preset.name, "rules": dict(preset.rules)} for preset in state.presets],
        "banned": state.banned[:],
        "words": list(state.words),
        "message": state.message,
        "tournament": state.tournament and tournament_course.save(state.tournament, now),
    }


def mend(saved: Mapping[str, Any]) -> tuple[Mapping[str, Any], list[str]]:
    """`saved` without decisions that nobody can have made, and what was wrong, for people.

    Earlier programs put "player 1" in the place of a rule's value, an unwanted word or a ban, too, when a player was
    forgotten whose name it was.
    """
    rules = saved.get("rules", {})
    lists = {name: saved.get(name, []) for name in ("words", "banned")}
    if not (isinstance(rules, dict) and all(isinstance(one, list) for one in lists.values())):
        return saved, []  # no state at all, as `restore` will say
    mended, faults = {**saved, "rules": dict(rules)}, []
    for rule in filter(rules.__contains__, DECLARED):
        try:
            checked(rule, rules[rule])
        except ValueError as error:
            del mended["rules"][rule]
            faults.append(f"the rule {rule} was {rules[rule]!r}, but {error}: it is as configured again")
    for name, what in (("words", "words that names may not contain"), ("banned", "banned names")):
        mended[name] = [one for one in lists[name] if not NEUTRAL.fullmatch(str(one))]
        if lost := len(lists[name]) - len(mended[name]):
            faults.append(f"{lost} of the {what} had become names of forgotten players: taken out, to be added again")
    return mended, faults


def restore(saved: Mapping[str, Any], known_robots: Mapping[str, int], now: float, pause: float) -> State:
    """The state that was saved `pause` s before `now`. ValueError if it is none.

    Battle and countdown have gone on unless they were paused; pages could not be heard, so their silence counts from
    now on, and robots are missed when they can be back. What an older program did not save yet is as if no operator
    had decided anything, and what only a newer one knows is left out.
    """
    try:
        then = now - pause
        robots = Robots(known_robots)
        for robot_id in saved.get("out_of_service", ()):
            robots.set_service(int(robot_id), False)
        for fields in saved["robots"]:
            if known_robots.get(fields["caller"], fields["id"]) != fields["id"]:
                continue  # the operator has given it another ID since: it registers anew
            back = robots.put(int(fields["id"]), fields["caller"], now, fields["key"], fields["address"])
            back.spared_until = now + ROBOTS_RETURN
            robots.link(int(fields["id"]), fields["linked"])
        is_paused = bool(saved.get("paused"))
        stood_at = then - float(saved.get("paused_for", 0))
        users = Users()
        for fields in saved["users"]:
            user = _restore_user(fields, then, now, stood_at)
            users.add_user(user)
            robot = robots.get_robot(user.robot)
            if robot is not None:
                robot.user = user.name
            elif user.robot_gone_at is None:
                user.robot_gone_at = now
        queue = [_restore_waiting(fields, then, now) for fields in saved["queue"]]
        for waiting in queue:
            offered = robots.get_robot(waiting.offer) if waiting.offer is not None else None
            if offered is not None:
                offered.user = waiting.name
        return State(
            robots=robots,
            users=users,
            game=Game(saved["game"]),
            ends_at=stood_at + float(saved["left"]),
            protected_until=stood_at + float(saved.get("protected", 0)),
            paused_at=stood_at if is_paused else None,
            battle=int(saved["battle"]),
            began_at=then + float(saved.get("began", 0)),
            lengths=tuple(map(float, saved.get("lengths", ()))),
            notice=str(saved["notice"]),
            queue=queue,
            leavers=[_restore_user(fields, then, now, stood_at) for fields in saved["leavers"]],
            result=tuple(Placing(**_known(Placing, fields)) for fields in saved["result"]),
            losing=tuple(Losing(**_known(Losing, fields)) for fields in saved.get("losing", ())),
            winning=tuple(Winning(**_known(Winning, fields)) for fields in saved.get("winning", ())),
            grudges=tuple(Grudge(**_known(Grudge, fields)) for fields in saved.get("grudges", ())),
            teams=int(saved.get("teams", 0)),
            pickups=PickUps.restore(saved["pickups"], stood_at) if "pickups" in saved else PickUps(),
            happened=tuple(Happening(**_known(Happening, fields)) for fields in saved.get("happened", ())),
            happenings=int(saved.get("happenings", 0)),
            bots={int(robot): str(level) for robot, level in saved.get("bots", {}).items()},
            rules={rule: value for rule, value in saved.get("rules", {}).items() if rule in DECLARED},
            presets=tuple(_restore_preset(fields) for fields in saved.get("presets", ())),
            banned=list(saved.get("banned", ())),
            words=tuple(saved.get("words", ())),
            message=str(saved.get("message", "")),
            tournament=restore_tournament(saved.get("tournament"), then),
        )
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"not a state of the game: {error!r}") from None


def _fields(one: _Kept) -> dict[str, Any]:
    return {name: getattr(one, name) for name in type(one).__slots__}


def _known(kind: type[_Kept], fields: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if name in kind.__slots__}


def restore_tournament(saved: dict[str, Any] | None, then: float) -> Tournament | None:
    """None too for what only another version knows: the battle goes on without it."""
    try:
        return tournament_course.restore(saved, then) if saved else None
    except (KeyError, TypeError, ValueError, IndexError):
        return None


def _restore_preset(fields: Mapping[str, Any]) -> Preset:
    rules = {rule: value for rule, value in fields["rules"].items() if rule in DECLARED}
    return Preset(str(fields["name"]), rules)


def _save_robot(robot: Robot) -> dict[str, Any]:
    return {
        "id": robot.id,
        "caller": robot.caller,
        "key": robot.key,
        "address": robot.address,
        "linked": robot.linked,
    }


def _save_user(user: User, now: float, stands_at: float) -> dict[str, Any]:
    return {
        "name": user.name,
        "robot": user.robot,
        "session": user.session,
        "avatar": user.avatar,
        "life": user.life,
        "ready": user.ready,
        "died": None if user.died_at is None else user.died_at - now,
        "left": None if user.left_at is None else user.left_at - now,
        "gone": None if user.robot_gone_at is None else user.robot_gone_at - now,
        "seated": user.seated_at - now,
        "battles": user.battles,
        "address": user.address,
        "wish": user.wish,
        "team": user.team,
        "handicap": user.handicap,
        "shots": user.shots,
        "hits": user.hits,
        "kills": user.kills,
        "taken": user.taken,
        "points": user.points,
        "effects": {kind: until - stands_at for kind, until in user.effects.items()},
        "fights": user.fights_since - now,
    }


def _save_waiting(waiting: Waiting, now: float) -> dict[str, Any]:
    return {
        "name": waiting.name,
        "session": waiting.session,
        "avatar": waiting.avatar,
        "offer": waiting.offer,
        "ends": waiting.offer_ends - now,
        "missed": waiting.missed,
        "first": waiting.first,
        "passed_on": waiting.passed_on,
        "address": waiting.address,
    }


def _restore_user(fields: Mapping[str, Any], then: float, now: float, stood_at: float) -> User:
    def moment(offset: float | None) -> float | None:
        return None if offset is None else then + offset

    counted = ("wish", "team", "handicap", "shots", "hits", "kills", "taken", "points")
    counts: dict[str, Any] = {name: int(fields.get(name, 0)) for name in counted}
    return User(
        name=fields["name"],
        robot=fields["robot"],
        session=fields["session"],
        avatar=fields["avatar"],
        seen=now,
        life=fields["life"],
        ready=fields["ready"],
        died_at=moment(fields["died"]),
        left_at=moment(fields["left"]),
        idle_since=now,
        ready_since=now,
        robot_gone_at=moment(fields["gone"]),
        seated_at=then + fields.get("seated", 0.0),
        battles=fields["battles"],
        address=fields["address"],
        fights_since=then + fields.get("fights", 0.0),
        **counts,
        effects={str(kind): stood_at + float(left) for kind, left in fields.get("effects", {}).items()},
    )


def _restore_waiting(fields: Mapping[str, Any], then: float, now: float) -> Waiting:
    return Waiting(
        name=fields["name"],
        session=fields["session"],
        avatar=fields["avatar"],
        seen=now,
        since=now,
        offer=fields["offer"],
        offer_ends=then + fields["ends"],
        missed=fields.get("missed", False),
        first=fields.get("first", False),
        passed_on=fields.get("passed_on", False),
        address=fields["address"],
    )
