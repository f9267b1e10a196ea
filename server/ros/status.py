"""The latched topic `/game_status`: everyone hears the state of the battle. Needs an initialised node."""

from collections.abc import Set

import rospy

from laser_bot_battle.msg import GameEvent, GameStatus, Place, UserStatus
from laser_bot_battle.names import GAME_STATUS
from laser_bot_battle.rospy_cures import latched_publisher
from server.game.robot_health import RobotsHealth
from server.game.snapshot import Snapshot


class StatusPublisher:
    def __init__(self, health: RobotsHealth) -> None:
        self._health = health
        self._publisher = latched_publisher(GAME_STATUS, GameStatus, queue_size=10)

    def publish(self, snapshot: Snapshot) -> None:
        """A listener of the game; rospy's own threads do the sending."""
        if not rospy.is_shutdown():
            self._publisher.publish(to_message(snapshot, self._health.weak()))


def to_message(snapshot: Snapshot, weak: Set[int] = frozenset()) -> GameStatus:
    """The wire form of a snapshot, see GameStatus.msg. `weak` are robots with too little voltage."""
    return GameStatus(
        game=snapshot.game.value,
        time_left=snapshot.time_left,
        protection=snapshot.protection,
        battle=snapshot.battle,
        notice=snapshot.notice,
        paused=snapshot.paused,
        message=snapshot.message,
        available_robots=snapshot.available_robots,
        practice=snapshot.practice,
        practice_beside=snapshot.practice_beside,
        teams=snapshot.teams,
        coded=snapshot.coded,
        hide_cameras=snapshot.hide_cameras,
        tournament=snapshot.tournament,
        queue=[waiter.name for waiter in snapshot.queue],
        users=[
            UserStatus(
                name=player.name,
                robot=player.robot,
                life=player.life,
                ready=player.ready,
                may_join=player.may_join,
                fence=player.fence_bits,
                avatar=player.avatar,
                session=player.session,
                seat_left=player.seat_left,
                team=player.team,
                handicap=player.handicap,
                shots=player.shots,
                hits=player.hits,
                kills=player.kills,
                points=player.points,
                effects=player.effect_bits,
                weak=player.robot in weak,
            )
            for player in snapshot.players
        ],
        result=[
            UserStatus(
                name=placing.name,
                robot=placing.robot,
                life=placing.life,
                avatar=placing.avatar,
                place=placing.place,
                left=placing.left,
                team=placing.team,
                shots=placing.shots,
                hits=placing.hits,
                kills=placing.kills,
                points=placing.points,
                taken=placing.taken,
                seconds=placing.seconds,
                wins=placing.wins,
            )
            for placing in snapshot.result
        ],
        places=[Place(kind=one.number, x=one.x, y=one.y, radius=one.radius) for one in snapshot.places],
        events=[
            GameEvent(
                number=one.number,
                kind=one.kind,
                name=one.name,
                by=one.by,
                life=one.life,
                streak=one.streak,
                revenge=one.revenge,
            )
            for one in snapshot.happened
        ],
    )
