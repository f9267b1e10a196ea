"""Whether the containers of a version that is new here run as well as those before."""

import time
from collections.abc import Callable, Collection

from cards.engine import Engine, inspect

LIMIT = 240.0  # s; the first start on a Raspberry Pi 3 takes up to 40 s
STEADY = 30.0  # s without a restart
_PERIOD = 2.0  # s between two looks


def healthy(engine: Engine, names: Collection[str]) -> set[str]:
    """Those of the containers that are. A robot without its Arduino, or without a master, is not."""
    found = {name: inspect(engine, name) for name in names}
    return {
        name for name, one in found.items() if one and (one["State"].get("Health") or {}).get("Status") == "healthy"
    }


def stopped(engine: Engine, names: Collection[str]) -> set[str]:
    """Those of the containers that a person has stopped. Others that end, the engine starts again, or says why not."""
    found = {name: inspect(engine, name) for name in names}
    return {
        name
        for name, one in found.items()
        if one and one["State"]["Status"] == "exited" and not one["State"].get("Error")
    }


def run(
    engine: Engine,
    names: Collection[str],
    were_healthy: Collection[str],
    clock: Callable[[], float] = time.monotonic,
    rest: Callable[[float], None] = time.sleep,
) -> bool:
    """Within `LIMIT`: whether all these containers are up for `STEADY` s, those healthy that were so before."""
    end = clock() + LIMIT
    since, last = clock(), None
    while (now := clock()) < end:
        found = [inspect(engine, name) for name in names]
        ups = [one["State"]["StartedAt"] for one in found if one and one["State"]["Running"]]
        if len(ups) < len(found) or ups != last or set(were_healthy) - healthy(engine, names):
            since, last = now, ups
        elif now - since >= STEADY:
            return True
        rest(_PERIOD)
    return False
