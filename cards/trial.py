"""Which of a card's containers run well: those of a version that is new here have to, as those before did."""

import time
from collections.abc import Callable, Collection
from typing import Any

from cards.engine import Engine, inspect

LIMIT = 240.0  # s; the first start on a Raspberry Pi 3 takes up to 40 s
STEADY = 30.0  # s without a restart
_PERIOD = 2.0  # s between two looks


def stopped(engine: Engine, names: Collection[str]) -> set[str]:
    """Those of the containers that a person has stopped. Others that end, the engine starts again, or says why not."""
    found = {name: inspect(engine, name) for name in names}
    return {
        name
        for name, one in found.items()
        if one and one["State"]["Status"] == "exited" and not one["State"].get("Error")
    }


def steady(
    engine: Engine,
    names: Collection[str],
    to_be_healthy: Collection[str],
    clock: Callable[[], float] = time.monotonic,
    rest: Callable[[float], None] = time.sleep,
) -> set[str]:
    """Those of the containers that have been up for `STEADY` s without a break, and healthy if they have to be: as soon
    as all are, or after `LIMIT` s."""
    end = clock() + LIMIT
    since: dict[str, tuple[Any, float]] = {}  # which start it is, and when that was first seen to be well
    while True:
        now = clock()
        for name in names:
            start = _start(inspect(engine, name), name in to_be_healthy)
            if start is None:
                since.pop(name, None)
            elif name not in since or since[name][0] != start:
                since[name] = (start, now)
        found = {name for name, (_, at) in since.items() if now - at >= STEADY}
        if len(found) == len(names) or now >= end:
            return found
        rest(_PERIOD)


def _start(one: Any, to_be_healthy: bool) -> Any:
    """When a container that is well was started; None for any other. A robot without its Arduino, or without a master,
    is not healthy."""
    if not one or not one["State"]["Running"]:
        return None
    is_healthy = (one["State"].get("Health") or {}).get("Status") == "healthy"
    return one["State"]["StartedAt"] if is_healthy or not to_be_healthy else None
