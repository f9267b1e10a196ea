"""A battle played again from its events."""

from collections.abc import Iterable

from server.game import changes, events, place_events
from server.game.events import Recorded
from server.game.snapshot import Placing
from server.game.state import State


def replay(recorded: Iterable[Recorded]) -> tuple[Placing, ...]:
    """The result of the last battle in these events, as they lead to it; () if none has ended.

    What the referee wrote down as its result is not looked at, but for the shots: not each of them is an event.
    """
    state = State()
    result: tuple[Placing, ...] = ()
    for one in recorded:
        match one.event:
            case events.BattleStarted(_, _, fighters):
                state = State()
                for fighter in fighters:
                    _seat(state, fighter, one.at)
                    changes.apply(state, events.ReadyChanged(fighter.name, True), one.at)
                changes.apply(state, one.event, one.at)
            case events.Joined():
                _seat(state, one.event, one.at)
                changes.apply(state, one.event, one.at)
            case (
                events.Hit() | place_events.HillHeld() | place_events.PickedUp() | events.Left() | events.Unseated()
            ) if state.users.get_user(one.event.name):
                changes.apply(state, one.event, one.at)
            case events.RobotGone(robot) if state.robots.get_robot(robot):
                changes.apply(state, one.event, one.at)
            case events.BattleEnded():
                for placing in one.event.result:
                    fought = state.fighter(placing.name)
                    if fought is not None:
                        fought.shots = placing.shots
                result = state.ranking()
    return result


def _seat(state: State, fighter: events.Fighter | events.Joined, at: float) -> None:
    changes.apply(state, events.RobotCame(fighter.robot, None), at)
    changes.apply(state, events.SignedUp(fighter.name, fighter.robot, "", fighter.avatar), at)
