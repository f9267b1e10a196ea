"""Whatever people, robots, operators and clocks do in whatever order: the rules hold."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from server.game import desk, events, tournament_desk
from server.game.emitter import DELAY, PULSE
from server.game.events import Recorded
from server.game.people import NAMELESS
from server.game.persistence import restore
from server.game.referee import Referee, Verdict
from server.game.replay import replay
from server.game.rules import Rules

NAMES = st.sampled_from(["ada", "bob", "cy", "dee", "eve", "fay"])
ROBOTS = st.integers(0, 3)
ROUNDS = st.lists(st.tuples(ROBOTS, ROBOTS, st.sampled_from([0.0, 0.1, 0.5])), min_size=5, max_size=20)


class Evening(RuleBasedStateMachine):
    """Robots 0 to 3, up to six people; each has one session."""

    def __init__(self) -> None:
        super().__init__()
        self.numbers = Rules(battle_limit=100, battles_in_row=2)
        self.referee = Referee(self.numbers)
        self.now = 0.0
        self.journal: list[Recorded] = []
        self.sessions: dict[str, str] = {}
        self.order: list[str] = []  # who waits, as last seen
        self.joined: set[str] = set()  # who has begun to wait since then
        self.missed: set[str] = set()  # who has let one person pass since then
        self.first: set[str] = set()  # who waits because of a robot that is out of service
        self.paused = False
        self.out: set[int] = set()  # robots out of service
        self.fired: list[tuple[float, str, set[str]]] = []  # shots: when, by whom, whom they have met
        self.told = True  # whether the hits that are reported now need a shot
        self.teams: dict[str, int] = {}  # of who fights
        self.friendly_fire = False
        self.safe_until = 0.0  # in this battle nobody can be hit before; pauses make it later

    @initialize(
        robots=st.integers(0, 4),
        people=st.integers(0, 6),
        light=st.sampled_from(["plain", "coded"]),
        teams=st.sampled_from([0, 2, 3, 4]),
        protection=st.sampled_from([0.0, 1.0]),
    )
    def some_are_there(self, robots: int, people: int, light: str, teams: int, protection: float) -> None:
        self.numbers = replace(self.numbers, light=light, teams=teams, protection=protection)
        self.referee = Referee(self.numbers)
        for robot in range(robots):
            self.robot_comes(robot)
        self.serial_nodes_come_and_go(set(range(robots)))
        for name in ("ada", "bob", "cy", "dee", "eve", "fay")[:people]:
            self.sign_up(name, wait=True, wanted=None, address="")

    @rule(robot=ROBOTS)
    def robot_comes(self, robot: int) -> None:
        self.referee.add_robot(f"/robot{robot}", self.now)

    @rule(linked=st.sets(ROBOTS))
    def serial_nodes_come_and_go(self, linked: set[int]) -> None:
        self.referee.robots_linked(linked, self.now)

    @rule(robot=ROBOTS, told=st.booleans())
    def hit(self, robot: int, told: bool) -> None:
        self.told = told
        self.referee.hit(robot, self.now, shots_told=told)
        self.note()

    @rule(robot=ROBOTS)
    def shoot(self, robot: int) -> None:
        if self.referee.shot(robot, self.now):
            fighter = next(one for one in self.referee.snapshot(self.now).players if one.robot == robot)
            assert fighter.ready
            assert fighter.life
            self.fired.append((self.now, fighter.name, set()))

    @rule(shooter=ROBOTS, victims=st.lists(ROBOTS, max_size=10), told=st.booleans(), code=st.integers(0, 255))
    def packets(self, shooter: int, victims: list[int], told: bool, code: int) -> None:
        self.told = told
        for victim in victims:
            self.referee.shot_hit(victim, shooter, code, self.now, shots_told=told)
        self.note()

    @precondition(lambda self: self.referee.snapshot(self.now).game == 2)
    @rule(rounds=ROUNDS)
    def they_fight(self, rounds: list[tuple[int, int, float]]) -> None:
        """By the light of the hour: who shoots, who is met, and how long until the next shot."""
        for shooter, victim, pause in rounds:
            self.shoot(shooter)
            for _ in range(2):
                self.hit(victim, True)
                self.packets(shooter, [victim], True, 5)
            self.time_passes(pause, present=True)

    @rule(name=NAMES, team=st.integers(-1, 5))
    def choose_team(self, name: str, team: int) -> None:
        self.referee.choose_team(name, team, self.sessions.get(name, ""), self.now)

    @rule(name=NAMES, wait=st.booleans(), wanted=st.none() | ROBOTS, address=st.sampled_from(["", "a", "b"]))
    def sign_up(self, name: str, wait: bool, wanted: int | None, address: str) -> None:
        """On a page that may have a session already."""
        token = f"{name} {self.now} {len(self.journal)}"
        old = self.sessions.get(name)
        _, who = self.referee.sign_up(
            name, token, 0, self.now, old_session=old, wanted=wanted, wait=wait, address=address
        )
        if who:
            self.sessions[name] = who.session

    @rule(name=NAMES)
    def sign_out(self, name: str) -> None:
        self.referee.sign_out(name, self.sessions.get(name, ""), self.now)

    @rule(name=NAMES)
    def take(self, name: str) -> None:
        self.referee.take_offer(self.sessions.get(name, ""), self.now)

    @rule(name=NAMES, ready=st.booleans())
    def ready(self, name: str, ready: bool) -> None:
        self.referee.set_ready(name, ready, self.sessions.get(name, ""), self.now)

    @rule(seconds=st.sampled_from([0.1, 1.0, 5.0, 30.0, 100.0]), present=st.booleans())
    def time_passes(self, seconds: float, present: bool) -> None:
        """With pings of all that is there, or of nobody."""
        end = self.now + seconds
        while self.now < end:
            self.now = min(end, self.now + (1.0 if present else seconds))
            if present:
                snapshot = self.referee.snapshot(self.now)
                for robot in snapshot.robots:
                    self.referee.robot_alive(robot, self.now)
                for session in [*(p.session for p in snapshot.players), *(w.session for w in snapshot.queue)]:
                    self.referee.seen(session, self.now)

    def operate(self, wish: Callable[..., Any], **wanted: Any) -> bool:
        try:
            self.referee.operate(partial(wish, by="Ann", **wanted), self.now)
        except desk.RefusedError:
            return False
        return True

    @rule(robot=ROBOTS)
    def operator_pauses_and_somebody_is_hit(self, robot: int) -> None:
        self.operate(desk.pause)
        self.hit(robot, False)

    @rule(wish=st.sampled_from([desk.pause, desk.resume, desk.abort, desk.start]))
    def operator_leads_the_battle(self, wish: Callable[..., Any]) -> None:
        self.operate(wish)

    @rule(seconds=st.sampled_from([1, 60]))
    def operator_adds_time(self, seconds: int) -> None:
        self.operate(desk.add_time, seconds=seconds)

    @rule(robot=ROBOTS, in_service=st.booleans())
    def operator_sets_service(self, robot: int, in_service: bool) -> None:
        self.operate(desk.set_service, robot_id=robot, in_service=in_service)

    @rule(robot=ROBOTS, level=st.sampled_from([None, "easy", "hard"]))
    def operator_gives_to_bot(self, robot: int, level: str | None) -> None:
        self.operate(desk.give_to_bot, robot_id=robot, level=level)

    @rule(name=NAMES, wish=st.sampled_from([desk.sign_out, desk.ban, desk.unban]))
    def operator_signs_out_or_bans(self, name: str, wish: Callable[..., Any]) -> None:
        self.operate(wish, name=name)

    @rule(
        changes=st.fixed_dictionaries(
            {},
            optional={
                "seats": st.none() | st.integers(0, 3),
                "hit_damage": st.sampled_from([None, 50, 100]),
                "countdown": st.sampled_from([None, 1, 15]),
                "battles_in_row": st.none() | st.integers(0, 2),
                "light": st.sampled_from(["plain", "coded"]),
                "teams": st.sampled_from([None, 2, 3, 4]),
                "friendly_fire": st.booleans(),
                "light_damage": st.booleans(),
                "handicap": st.sampled_from([None, 50]),
                "late_join": st.booleans(),
            },
        )
    )
    def operator_changes_rules(self, changes: dict[str, Any]) -> None:
        self.operate(desk.change_rules, changes=changes)

    @rule(people=st.integers(4, 6), best_of=st.sampled_from([1, 3]), patience=st.sampled_from([0, 60]))
    def operator_opens_a_tournament(self, people: int, best_of: int, patience: int) -> None:
        names = ("ada", "bob", "cy", "dee", "eve", "fay")[:people]
        self.operate(tournament_desk.open_one, names=names, best_of=best_of, patience=patience)

    @rule(number=st.none() | st.integers(1, 5))
    def operator_calls_a_match(self, number: int | None) -> None:
        self.operate(tournament_desk.call, number=number)

    @rule(number=st.integers(1, 5), name=NAMES)
    def operator_corrects_or_says_who_is_missing(self, number: int, name: str) -> None:
        if not self.operate(tournament_desk.no_show, number=number, name=name):
            self.operate(tournament_desk.correct, number=number, winner=name, reason="seen")

    @rule()
    def operator_closes_the_tournament(self) -> None:
        self.operate(tournament_desk.close)

    @rule(pause=st.sampled_from([0.0, 2.0, 60.0]))
    def the_program_is_killed(self, pause: float) -> None:
        self.note()
        known = {f"/robot{robot}": robot for robot in range(4)}
        state = restore(self.referee.saved(self.now), known, self.now + pause, pause)
        self.referee, self.now = Referee(self.numbers, state), self.now + pause

    @precondition(lambda self: len(self.referee.snapshot(self.now).players) >= 2)
    @rule(rounds=ROUNDS)
    def two_ready_players_get_a_battle(self, rounds: list[tuple[int, int, float]]) -> None:
        """From any state, as soon as the running battle is over, while nobody pauses or aborts it, and no match of a
        tournament is waited for."""
        self.operate(tournament_desk.close)
        self.operate(desk.resume)
        if self.referee.snapshot(self.now).game == 2:
            self.operate(desk.abort)
            assert self.referee.snapshot(self.now).game == 0
        players = self.referee.snapshot(self.now).players
        for player in players:
            self.referee.set_ready(player.name, True, player.session, self.now)
        alive = [player for player in players if player.robot in self.referee.snapshot(self.now).robots]
        if len(alive) >= 2:
            for _ in range(17):
                self.time_passes(1.0, present=True)
            assert self.referee.snapshot(self.now).game == 2
            self.they_fight(rounds)

    def note(self) -> None:
        """What has been decided: no hit and no start in a pause, nothing of a robot that is out of service."""
        decided = self.referee.take_journal()
        self.journal += decided
        for at, event in ((one.at, one.event) for one in decided):
            self.note_cause(event)
            match event:
                case events.Queued(name) | events.Left(name) | events.Seated(name):
                    self.first.discard(name)
                    self.joined.add(name)
                case events.OfferMissed(name):
                    self.first.discard(name)
                    self.missed.add(name)
                case events.Unseated(name):
                    (self.first.add if event.first else self.first.discard)(name)
                    self.joined.add(name)
                case events.Paused() | events.Resumed():
                    self.paused = isinstance(event, events.Paused)
                case events.BattleEnded() | events.CountdownStopped():
                    self.paused = False
                case events.Hit(name, _, _, by):
                    assert not self.paused
                    assert at >= self.safe_until
                    self.note_hit(name, by)
                case events.RulesChanged(changes) if "friendly_fire" in changes:
                    self.friendly_fire = bool(changes["friendly_fire"])
                case events.BattleStarted(_, _, fighters):
                    assert event.by or not self.paused
                    self.paused = False
                    self.note_teams(fighters, event.teams)
                    self.safe_until = at + self.numbers.protection
                case events.Joined(name):
                    assert not self.paused
                    assert name not in self.teams
                    self.teams[name] = 0
                case events.ServiceChanged(robot, in_service):
                    (self.out.discard if in_service else self.out.add)(robot)
                case events.Offered(_, robot) | events.SignedUp(_, robot):
                    assert robot not in self.out

    def note_cause(self, event: events.Event) -> None:
        """It begins with a name, or names nobody: so who is forgotten is found in it."""
        if isinstance(event, events.BattleEnded | events.CountdownStopped) and event.cause not in NAMELESS:
            assert event.cause.split()[0] in {"ada", "bob", "cy", "dee", "eve", "fay"}
            assert event.cause.partition(" ")[2]

    def note_hit(self, name: str, by: str) -> None:
        """A hit is of somebody else, and of a shot under way that has not met this one yet."""
        assert by != name
        if by and not self.friendly_fire:
            assert not self.teams[name] or self.teams[name] != self.teams[by]
        if self.told:
            shots = [one for one in self.fired if self.now - one[0] <= PULSE + DELAY and one[1] != name]
            assert [one for one in shots if by in {"", one[1]} and (not by or name not in one[2])]
            if by:
                next(one for one in shots if one[1] == by and name not in one[2])[2].add(name)

    def note_teams(self, fighters: Iterable[events.Fighter], teams: int) -> None:
        """There are two sides at least, and no team that there is not."""
        self.teams = {fighter.name: fighter.team for fighter in fighters}
        if teams:
            assert len(set(self.teams.values())) >= 2
            assert set(self.teams.values()) <= set(range(1, teams + 1))
        else:
            assert set(self.teams.values()) == {0}

    @invariant()
    def a_battle_has_two_sides(self) -> None:
        snapshot = self.referee.snapshot(self.now)
        if snapshot.game == 2:
            alive = [player for player in snapshot.players if player.ready and player.life]
            assert len({player.team or player.name for player in alive}) >= 2

    @invariant()
    def who_stands_together_shares_a_place(self) -> None:
        result = self.referee.snapshot(self.now).result
        for team in {placing.team for placing in result} - {0}:
            assert len({placing.place for placing in result if placing.team == team and not placing.left}) <= 1
        assert [placing.place for placing in result] == sorted(placing.place for placing in result)

    @invariant()
    def what_is_paused_is_paused(self) -> None:
        self.note()
        assert self.referee.snapshot(self.now).paused is self.paused

    @invariant()
    def nobody_drives_a_robot_that_is_out_of_service(self) -> None:
        snapshot = self.referee.snapshot(self.now)
        self.note()
        assert not self.out & {player.robot for player in snapshot.players}
        assert not self.out & {waiter.offer for waiter in snapshot.queue}

    @invariant()
    def nobody_sits_twice(self) -> None:
        snapshot = self.referee.snapshot(self.now)
        names = [player.name for player in snapshot.players] + [waiter.name for waiter in snapshot.queue]
        robots = [player.robot for player in snapshot.players] + [
            waiter.offer for waiter in snapshot.queue if waiter.offer is not None
        ]
        assert len(set(names)) == len(names)
        assert len(set(robots)) == len(robots)
        assert snapshot.available_robots <= len(snapshot.robots) - len(set(robots) & set(snapshot.robots))

    @invariant()
    def only_the_players_of_a_match_that_is_called_are_ready(self) -> None:
        snapshot = self.referee.snapshot(self.now)
        tournament = self.referee.overview(self.now)["tournament"] if snapshot.tournament else None
        if tournament and tournament["called"]:
            called = tournament["matches"][tournament["called"] - 1]["players"]
            assert {player.name for player in snapshot.players if player.ready} <= set(called)

    @invariant()
    def no_robot_stands_idle_while_somebody_waits_without_an_offer(self) -> None:
        snapshot = self.referee.snapshot(self.now)
        if any(waiter.offer is None for waiter in snapshot.queue):
            assert snapshot.available_robots == 0

    @invariant()
    def nobody_is_overtaken(self) -> None:
        """Whoever came later, or comes back after a seat, stands behind those who wait already; whoever has lost a
        robot to the operator stands behind those who have, too. Whoever misses an offer lets the next one pass."""
        waiting = [waiter.name for waiter in self.referee.snapshot(self.now).queue]
        self.note()
        firsts = [name for name in waiting if name in self.first]
        assert waiting[: len(firsts)] == firsts
        for everybody in (firsts, waiting[len(firsts) :]):
            kind = [name for name in everybody if name not in self.missed]
            stayed = [name for name in kind if name not in self.joined]
            assert kind[: len(stayed)] == stayed
            assert [name for name in self.order if name in stayed] == stayed
        self.order, self.joined, self.missed = waiting, set(), set()

    @invariant()
    def every_battle_has_a_winner_and_the_result_that_its_events_lead_to(self) -> None:
        ended = next((one.event for one in reversed(self.journal) if isinstance(one.event, events.BattleEnded)), None)
        if ended:
            assert ended.result[0].place == 1
            assert replay(self.journal) == ended.result

    @invariant()
    def verdicts_are_never_lies(self) -> None:
        for name in ("ada", "bob"):
            verdict, player = self.referee.take_offer(f"not {name}", self.now)
            assert (verdict, player) == (Verdict.UNKNOWN_USER, None)


TestEvening = Evening.TestCase
TestEvening.settings = settings(max_examples=100, stateful_step_count=50, suppress_health_check=list(HealthCheck))
