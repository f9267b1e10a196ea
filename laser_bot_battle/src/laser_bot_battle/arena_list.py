"""The arenas that an entrance leads to, as a setting lists them: `red=:30510 blue=https://blue.example@10.0.0.7:5000`."""

import re
from typing import NamedTuple

MAX_ARENAS = 1000
_HOST = r"(?:[a-z0-9._-]+|\[[0-9a-f:.]+\])"
_WORD = re.compile(
    rf"(?P<name>[A-Za-z0-9_-]{{1,40}})=(?P<public>:[0-9]{{1,5}}|https?://{_HOST}(?::[0-9]{{1,5}})?)"
    rf"(?:@(?P<inside>{_HOST}:[0-9]{{1,5}}))?"
)


class ListedArena(NamedTuple):
    """Where an arena's pages are."""

    name: str
    public: str  # for browsers: an address, or a port such as :30510 of the host at which they found the entrance
    inside: str  # where the entrance asks, as http://host:port


def read_arenas(text: str) -> tuple[ListedArena, ...]:
    """ValueError for what is no such list."""
    arenas = tuple(map(_arena, text.split()))
    names = [arena.name for arena in arenas]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{name} is listed twice")
    if len(arenas) > MAX_ARENAS:
        raise ValueError(f"must be at most {MAX_ARENAS} arenas, not {len(arenas)}")
    return arenas


def _arena(word: str) -> ListedArena:
    found = _WORD.fullmatch(word)
    if not found or any(not 0 < int(port) < 2**16 for port in re.findall(r":([0-9]+)(?=@|$)", word)):
        raise ValueError(
            f"{word!r} is not name=:port or name=https://host, perhaps with @host:port, where the entrance asks"
        )
    name, public, inside = found["name"], found["public"], found["inside"]
    if inside:
        return ListedArena(name, public, f"http://{inside}")
    return ListedArena(name, public, f"http://localhost{public}" if public.startswith(":") else public)
