"""The latched topic `/game_status`: everyone hears the state of the battle. Needs an initialised node."""

import rospy

from laser_bot_battle.msg import GameStatus, UserStatus
from laser_bot_battle.names import GAME_STATUS
from server.game.snapshot import Snapshot


class StatusPublisher:
    def __init__(self) -> None:
        self._publisher = rospy.Publisher(GAME_STATUS, GameStatus, latch=True, queue_size=10)

    def publish(self, snapshot: Snapshot) -> None:
        """A listener of the game; rospy's own threads do the sending."""
        if not rospy.is_shutdown():
            self._publisher.publish(to_message(snapshot))


def to_message(snapshot: Snapshot) -> GameStatus:
    """The wire form of a snapshot, see GameStatus.msg."""
    return GameStatus(
        game=snapshot.game.value,
        time_left=snapshot.time_left,
        battle=snapshot.battle,
        notice=snapshot.notice,
        paused=snapshot.paused,
        message=snapshot.message,
        available_robots=snapshot.available_robots,
        practice=snapshot.practice,
        queue=[waiter.name for waiter in snapshot.queue],
        users=[
            UserStatus(
                name=player.name,
                robot=player.robot,
                life=player.life,
                ready=player.ready,
                avatar=player.avatar,
                session=player.session,
                seat_left=player.seat_left,
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
            )
            for placing in snapshot.result
        ],
    )
