"""What is wrong above the floor, for people: said while it lasts, and not for a single picture's sake. Pure."""

from dataclasses import dataclass

ENOUGH = 3  # times that something must be noticed until it is believed
LASTING = 1.0  # s; what is not noticed again within this time is over


@dataclass
class _Trouble:
    text: str
    times: int
    noticed: float  # last


class Troubles:
    """Told apart by keys. Times are in s, of a clock that only goes on."""

    def __init__(self) -> None:
        self._all: dict[object, _Trouble] = {}

    def notice(self, key: object, text: str, now: float) -> None:
        trouble = self._all.get(key)
        times = trouble.times if trouble and now - trouble.noticed <= LASTING else 0
        self._all[key] = _Trouble(text, times + 1, now)

    def believed(self, now: float) -> dict[object, str]:
        """The texts of all that are believed now, by key."""
        self._all = {key: trouble for key, trouble in self._all.items() if now - trouble.noticed <= LASTING}
        return {key: trouble.text for key, trouble in self._all.items() if trouble.times >= ENOUGH}
