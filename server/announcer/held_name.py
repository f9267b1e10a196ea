"""Names of the network that we hold, and that another machine may hold, too."""

import asyncio
import contextlib
from collections.abc import Callable, Iterable

from zeroconf import DNSOutgoing, DNSQuestion, DNSRecord, RecordUpdate, RecordUpdateListener, Zeroconf

ADDRESS, SERVICE = 1, 33  # types of records: A and SRV
SOONEST, LATEST = 1.0, 30.0  # s between two questions whether another machine answers, too
_INTERNET = 1  # class of a DNS question
_QUESTION = 0  # flags


class Challenge(RecordUpdateListener):
    """Waits for a stronger machine that holds the name `name`, too: we are to yield.

    It happens although everybody asks before taking a name: two ask at the same time, or two networks become one.
    `stronger` says which machine a record of the name, of type `kind`, is from if that one is stronger.
    """

    def __init__(self, zeroconf: Zeroconf, name: str, kind: int, stronger: Callable[[DNSRecord], str | None]) -> None:
        super().__init__()
        self._zeroconf = zeroconf
        self._question = DNSQuestion(name, kind, _INTERNET)
        self._stronger = stronger
        self._found: asyncio.Future[str] = asyncio.get_running_loop().create_future()

    async def wait(self) -> str:
        """The stronger machine, when it is heard, or was since the name was asked for."""
        self._zeroconf.async_add_listener(self, self._question)
        pause = SOONEST
        try:
            while not self._found.done():
                self._ask()
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(asyncio.shield(self._found), pause)
                pause = min(2 * pause, LATEST)
            return self._found.result()
        finally:
            self._zeroconf.async_remove_listener(self)

    def _ask(self) -> None:
        """The answers come by multicast; others' questions may be answered to them alone."""
        packet = DNSOutgoing(_QUESTION)
        packet.add_question(self._question)
        self._zeroconf.async_send(packet)

    def async_update_records(self, zc: Zeroconf, now: float, records: Iterable[RecordUpdate]) -> None:
        """Called by zeroconf, in the loop, with what it has heard."""
        for record in (update.new for update in records):
            if self._question.answered_by(record) and not record.is_expired(now) and not self._found.done():
                found = self._stronger(record)
                if found:
                    self._found.set_result(found)
