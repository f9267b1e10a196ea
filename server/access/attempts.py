"""Wrong operator tokens: anyone who guesses is slowed down."""

FREE = 5  # wrong tokens of one address at once, then
PERIOD = 1.0  # s for each further one
MAX_ADDRESSES = 1000  # that are remembered


class Attempts:
    """Wrong tokens by the address that they came from. Time is a monotonic clock in s."""

    def __init__(self) -> None:
        self._forgotten: dict[str, float] = {}  # when an address is as good as new; the one of the last attempt is last

    def allowed(self, address: str, now: float) -> bool:
        """Whether a token from that address may be looked at."""
        return self._forgotten.get(address, now) - now <= (FREE - 1) * PERIOD

    def wrong(self, address: str, now: float) -> None:
        """A token from that address was wrong."""
        self._forgotten[address] = max(self._forgotten.pop(address, now), now) + PERIOD
        if len(self._forgotten) > MAX_ADDRESSES:
            del self._forgotten[next(iter(self._forgotten))]
