"""What every family of operations has in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from server.rosbridge.effects import Effect
from server.rosbridge.wire import Request

if TYPE_CHECKING:
    from server.rosbridge.protocol import Session

Handler = Callable[[Request, float], list[Effect]]  # (request, monotonic time in s); RequestError refuses the request


class Family(ABC):
    """Operations that belong together, and what one client has open through them."""

    def __init__(self, session: Session) -> None:
        self.session = session

    @abstractmethod
    def handlers(self) -> Mapping[str, Handler]:
        """The operations by name."""

    def updated(self, now: float) -> list[Effect]:
        """The battle has changed, or some time has passed."""
        return []

    def closed(self) -> list[Effect]:
        """The client is gone: close what it had open."""
        return []
