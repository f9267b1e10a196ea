"""Who sees what, by the newest /game_status (docs/protocol-camera.md)."""

from laser_bot_battle.msg import GameStatus
from laser_bot_battle.names import ABOVE
from server.access.identity import Identity, People


class CameraAccess(People):
    """The people, and what they may look at. A referee that falls silent changes nothing: the battle goes on."""

    def __init__(self, operator_token: str) -> None:
        """An empty `operator_token`: nobody is an operator."""
        super().__init__(operator_token)
        self.is_known = False
        """whether the referee has spoken: before, nobody but operators may see anything"""
        self._running = self._hidden = False

    def hear(self, status: GameStatus) -> None:
        super().hear(status)
        self.is_known = True
        self._running = status.game != GameStatus.STOPPED
        self._hidden = status.hide_cameras

    def refuses(self, who: Identity, robot: int) -> str:
        """Why this viewer may not look through the robot's camera, or the one ABOVE, now; empty: they may."""
        if who.foreign:  # a browser in this network would show the hall to whoever has made the page
            return "this page is not at the game's own address: sign in to see through the cameras"
        if robot == ABOVE:  # everybody may know where robots are
            return ""
        player = self.player(who)
        if not self._running or who.operator or self.is_own(who, robot):
            return ""
        if player and player.ready:
            return "in a battle you see through your own robot's camera only"
        return "the cameras are hidden while a battle runs" if self._hidden else ""

    def is_own(self, who: Identity, robot: int) -> bool:
        """Whether the viewer is the player of that robot."""
        player = self.player(who)
        return player is not None and player.robot == robot
