"""What every capability has in common."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping

from server.rosbridge.context import Context
from server.rosbridge.effects import Effect
from server.websocket.requests import Request

Handler = Callable[[Request, float], list[Effect]]  # (request, monotonic time in s); RequestError refuses the request


class Capability(ABC):
    """Operations that belong together, and what one client has open through them."""

    def __init__(self, client: Context) -> None:
        self.client = client

    @abstractmethod
    def handlers(self) -> Mapping[str, Handler]:
        """The operations by name."""

    def updated(self, now: float) -> list[Effect]:
        """The battle has changed, or some time has passed."""
        return []

    def closed(self) -> list[Effect]:
        """The client is gone: close what it had open."""
        return []


def compression(request: Request, known: tuple[str, ...]) -> str:
    """How the client wants the answers to this request; as it is by default if it wants what nobody knows, as
    upstream."""
    value = request.optional_text("compression", "none")
    return value if value in known else "none"


def fragment_size(request: Request) -> int | None:
    """Of how many characters the client wants texts at most; None: as they are."""
    return request.count("fragment_size", 0) or None
