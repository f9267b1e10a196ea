"""The state of the game, changed by events only (`server.game.changes`). The referee decides them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from laser_bot_battle.names import Game
from server.game import events
from server.game.handicap import Losing, handicap
from server.game.people import Notice, Words
from server.game.pickups import PickUps
from server.game.presets import Preset
from server.game.ranking import ranks
from server.game.rivalry import Grudge, Winning
from server.game.robot import Robots
from server.game.rules import Rules
from server.game.snapshot import Happening, Placing
from server.game.teams import deal
from server.game.tournament import Tournament
from server.game.users import User, Users, Waiting, is_same_name

TOLD = 8  # of the hits of a battle, the newest; and as many of those that were refused
MEASURED = 5  # battles, by which waiting times are told


@dataclass
class State:
    """All times are monotonic seconds."""

    robots: Robots = field(default_factory=Robots)
    users: Users = field(default_factory=Users)
    game: Game = Game.STOPPED
    ends_at: float = 0.0  # of the countdown or the battle; while it is paused, as if it went on at once
    paused_at: float | None = None  # None: it is not
    battle: int = 0
    protected_until: float = 0.0  # in it nobody can be hit before; while it is paused, as if it went on at once
    began_at: float = 0.0  # the running or the last battle, later by its pauses
    lengths: tuple[float, ...] = ()  # s of the last battles, at most `MEASURED`
    notice: Notice = ""
    held: events.Held | None = None  # why no countdown begins
    held_at: float = 0.0
    held_until: float = 0.0
    may_hold_until: dict[int | None, float] = field(default_factory=dict)  # by robot that has held, None: the server
    queue: list[Waiting] = field(default_factory=list)  # for a robot, the next one first
    leavers: list[User] = field(default_factory=list)  # who was in the running battle and has gone
    result: tuple[Placing, ...] = ()
    losing: tuple[Losing, ...] = ()  # who has won none of the last battles
    winning: tuple[Winning, ...] = ()  # who has won all of them
    grudges: tuple[Grudge, ...] = ()
    teams: int = 0  # of the running or the last battle; 0: everybody fights alone
    pickups: PickUps = field(default_factory=PickUps)  # of the running or the last battle
    happened: tuple[Happening, ...] = ()  # in it, see `TOLD`
    happenings: int = 0  # in all battles so far
    # what operators have decided
    rules: Mapping[str, Any] = field(default_factory=dict)  # values instead of the environment's
    presets: tuple[Preset, ...] = ()
    bots: dict[int, str] = field(default_factory=dict)  # by robot: a level, or that it is for people only
    banned: list[str] = field(default_factory=list)  # names; who is banned is not forgotten
    words: tuple[str, ...] = ()  # that names may not contain
    message: Words = ""
    tournament: Tournament | None = None  # the open one, or the last

    def time_left(self, now: float) -> float:
        """Seconds to the battle, or to its time limit; 0 when neither runs."""
        if self.game is Game.STOPPED:
            return 0.0
        return max(0.0, self.ends_at - (now if self.paused_at is None else self.paused_at))

    def protection_left(self, now: float) -> float:
        """Seconds for which nobody can be hit; 0 when somebody can, and without a battle."""
        if self.game is not Game.PLAYING:
            return 0.0
        return max(0.0, self.protected_until - (now if self.paused_at is None else self.paused_at))

    def notice_now(self) -> str:
        """Also why those who are ready wait."""
        waits = self.held is not None and self.game is Game.STOPPED and len(self.users.get_users_ready()) > 1
        return self.held.notice if self.held is not None and waits else self.notice

    def kept_robot(self, name: str) -> int | None:
        """The robot that is kept for that player, who is called to a match; None: for this one there is none."""
        called = self.tournament.called() if self.tournament else {}
        return next((robot for one, robot in called.items() if is_same_name(one, name)), None)

    @property
    def is_match(self) -> bool:
        """Whether the next battle is one of a tournament, in which only its two players fight."""
        return self.tournament is not None and self.tournament.call is not None

    def may_fight(self, name: str) -> bool:
        """Whether that player may be in the next battle."""
        return not self.is_match or self.kept_robot(name) is not None

    def terms(self, rules: Rules) -> tuple[int, int]:
        """Of the next battle: the number of teams, and the handicap in percent. In a match there is neither."""
        return (0, 0) if self.is_match else (rules.teams, rules.handicap)

    def next_battle(self, rules: Rules, by: str = "") -> events.BattleStarted:
        """The start of a battle of all who are ready."""
        ready = self.users.get_users_ready()
        teams, spared = self.terms(rules)
        dealt = zip(ready, deal(ready, teams), strict=True)
        fighters = tuple(
            events.Fighter(user.name, user.robot, user.avatar, team, handicap(user.name, self.losing, spared))
            for user, team in dealt
        )
        return events.BattleStarted(
            self.battle + 1, rules.battle_limit, fighters, by, teams, protection=rules.protection
        )

    def is_open(self, rules: Rules) -> bool:
        """Whether the battle that runs can still be joined."""
        joins = rules.late_join and not self.teams and not self.is_match
        return joins and self.game is Game.PLAYING and self.paused_at is None

    def may_join(self, user: User, rules: Rules) -> bool:
        """Whether this player can still join the battle that runs. Nobody fights in it twice: neither under the same
        name nor, under another one, with the same robot."""
        has_left = any(is_same_name(one.name, user.name) or one.robot == user.robot for one in self.leavers)
        return self.is_open(rules) and not user.ready and not has_left and user.robot_gone_at is None

    def join(self, user: User, rules: Rules) -> events.Joined:
        """The player joins with no more life than the weakest has."""
        life = min(fighter.life for fighter in self.users.get_users_alive())
        spared = handicap(user.name, self.losing, rules.handicap)
        return events.Joined(user.name, user.robot, user.avatar, life, spared)

    def fighter(self, name: str) -> User | None:
        """Who fights in the running battle under that name, or has fought in it and left."""
        return next((user for user in [*self.users.get_users_ready(), *self.leavers] if user.name == name), None)

    def ranking(self) -> tuple[Placing, ...]:
        """Of the running battle, best first; who stands equal shares the place, and the places after it stay empty."""
        ranked = ranks([*self.users.get_users_ready(), *self.leavers])
        standings = [rank.result for rank, _ in ranked]
        return tuple(
            Placing(
                name=user.name,
                robot=user.robot,
                life=user.life,
                avatar=user.avatar,
                place=standings.index(rank.result) + 1,
                left=user.left_at is not None,
                team=user.team,
                shots=user.shots,
                hits=user.hits,
                kills=user.kills,
                taken=user.taken,
                points=user.points,
            )
            for rank, user in ranked
        )

    def waiting(self, name: str) -> Waiting:
        """The one who waits under that name. KeyError when nobody does."""
        found = next((waiting for waiting in self.queue if waiting.name == name), None)
        if found is None:
            raise KeyError(f"nobody waits as {name}")
        return found
