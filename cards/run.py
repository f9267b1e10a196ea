"""Runs the card's containers as laserbot.txt says, at each start once the engine answers, and when there is another
version of the game.

    python3 -m cards.run [--boot FOLDER]

The engine starts again by itself what it has. It lacks them at the first start, after the state was made anew, and
when laserbot.txt has changed. A version that is new here has to show that it runs; if it does not, the next best is
run instead.
"""

import argparse
import socket
import subprocess
import sys
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

from cards import trial
from cards.containers import LABEL, Container, containers
from cards.engine import LOAD, PING, Engine, EngineError, Socket, do, inspect
from cards.files import MASTER_HOST, STATE
from cards.laserbot_txt import Card
from cards.start import own_role, read
from cards.store import Store
from cards.telling import tell, topic_of
from cards.values import PREVIOUS
from cards.versions import candidates, failed, kept, proven

HERE = Path(__file__).resolve().parents[1]
ENGINE = "/run/docker.sock"
UNIT = "laserbot-containers.service"
TRIES = 12  # of this program in a row, 10 s apart, before the engine is given up

Steady = Callable[[Engine, Collection[str], Collection[str]], set[str]]  # as trial.steady


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--boot", type=Path, default=Path("/boot/firmware"), help="the card's first partition")
    arguments = parser.parse_args()
    card, _ = read(arguments.boot, own_role())
    telling = partial(tell, arguments.boot)
    return run(
        Socket(ENGINE), Store(STATE, HERE), card, socket.gethostname(), tell=telling, tries=_tries(), restart=_restart
    )


def run(
    engine: Engine,
    store: Store,
    card: Card,
    host: str,
    *,
    tell: Callable[[str, str], None],
    tries: int,
    restart: Callable[[], None],
    steady: Steady = trial.steady,
) -> int:
    """The program's exit code: 1 if it has to be tried again; `tries` have failed since the host was started. `tell` is
    told each topic and its problem, or that there is none any more. `restart` is for the host."""
    topic, problem = "the game cannot be started", ""
    try:
        settle(engine, store, card, host, tell=tell, steady=steady)
        store.engine_is_well()
    except ValueError as error:
        problem = str(error)
    except (EngineError, OSError) as error:
        problem = str(error)
        # what a cut has left of the engine's files may be of no use, while the file system is as it should be
        if tries >= TRIES and not _plays(engine) and store.give_up_the_engine():
            restart()
    tell(topic, problem)
    return 1 if problem else 0


def _plays(engine: Engine) -> bool:
    """Whether any container runs."""
    try:
        return bool(do(engine, "GET", "/containers/json"))
    except (EngineError, OSError):
        return False


def _tries() -> int:
    command = ["systemctl", "show", "--property", "NRestarts", "--value", UNIT]
    return int(subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout)


def _restart() -> None:
    subprocess.run(["systemctl", "reboot"], check=True)


def settle(
    engine: Engine,
    store: Store,
    card: Card,
    host: str,
    *,
    tell: Callable[[str, str], None],
    steady: Steady,
) -> None:
    """Run the version that is wished or, if it does not run, the next best, and serve it to the robots.

    EngineError or ValueError if not even the card's own runs; OSError if the engine is away.
    """
    do(engine, "GET", PING)
    state, back = store.state(), card.version == PREVIOUS
    versions = candidates(state, back, store.stored(), store.own)
    for version, other in zip_longest(versions, versions[1:]):
        topic = topic_of(version)
        try:
            wanted = containers(card, host, store.described(version))
            stopped = trial.stopped(engine, wanted)
            arrange(engine, wanted, store, version)
            failing = set()
            if version == state.trial:
                failing = _failing(engine, store, card, wanted, stopped=stopped, steady=steady)
            if not failing:
                if version == state.trial:
                    for old in {*state.refused, state.current, state.previous}:
                        tell(topic_of(old), "")  # of no interest any more
                    state = proven(state)
                    store.remember(state)
                tell(topic, "")
                break
            reason = f"these do not stay up, or are not healthy: {', '.join(sorted(failing))}"
        except (EngineError, ValueError) as error:
            if other is None:
                raise
            reason = str(error)
        made = ", with which the card was made," if other == store.own else ""
        tell(topic, f"{reason}; version {other}{made} is run instead" if other else reason)
        if version == state.trial:
            state = failed(state)
            store.remember(state)
    store.tidy(state)
    _tidy_images(engine, store, {*kept(state), version})
    if card.role == "master" and version == (state.previous if back else state.current):
        store.serve(version, card.arena or MASTER_HOST)
    if card.role == "master":  # for the next trial; after a start of the host, it would be too early to look
        running = set(wanted) - trial.stopped(engine, wanted)
        store.remember_healthy(steady(engine, running, running))


def _failing(
    engine: Engine, store: Store, card: Card, wanted: Collection[str], *, stopped: Collection[str], steady: Steady
) -> set[str]:
    """Those of the containers of a version on trial that do not run well; `stopped` were so by a person before."""
    # they say nothing of a version, unless they are all, and it has changed them: then they run again
    judged = {*wanted} - {*stopped} or {*wanted} - trial.stopped(engine, wanted)
    if card.role == "robot":  # its health hangs on its master and its Arduino
        return judged - steady(engine, judged, ())
    # as many as with the version before; if it is not known of any, all
    return judged - steady(engine, judged, judged & store.healthy() or judged)


def arrange(engine: Engine, wanted: Mapping[str, Container], store: Store, version: str) -> None:
    """Give the engine the containers it lacks, and take from it the card's others; they are those of that version.

    One that Ansible has deployed stays, and so does one that is as wanted, even if a person has stopped it.
    """
    there = do(engine, "GET", "/containers/json?all=1")
    own = {one["Names"][0].removeprefix("/") for one in there if LABEL in (one["Labels"] or {})}
    old, new = set(), set()
    for name in {*wanted, *own}:
        found = inspect(engine, name)
        if found:
            label = _label(found)
            if label is None:
                continue
            # one that was made and never started was cut off
            if name in wanted and label == wanted[name]["Labels"][LABEL] and found["State"]["Status"] != "created":
                continue
            old.add(name)
        if name in wanted:
            new.add(name)
    load(engine, store, version, {wanted[name]["Image"] for name in new})  # takes long: the old ones run meanwhile
    for name in sorted(old | new):
        if name in old:
            do(engine, "DELETE", f"/containers/{name}?force=1")
        if name in new:
            do(engine, "POST", f"/containers/create?name={name}", wanted[name])
            do(engine, "POST", f"/containers/{name}/start")
            print(f"started {name}", file=sys.stderr)


def load(engine: Engine, store: Store, version: str, images: Collection[str]) -> None:
    """Give the engine what it lacks of these images of that version."""
    if all(engine.ask("GET", f"/images/{image}/json")[0] == 200 for image in images):
        return
    print("loading the image", file=sys.stderr)
    archive = store.image(version)
    try:
        opened = archive.open("rb")
    except OSError as error:
        raise ValueError(f"{archive.name} cannot be read: {error.strerror}") from None
    with opened, store.loading():
        answer = str(do(engine, "POST", LOAD, opened))
    if "errorDetail" in answer:  # found after the engine has begun to answer
        raise EngineError(f"the engine cannot load {archive.name}: {answer.strip()}")


def is_deployed_to(engine: Engine, names: Collection[str]) -> bool:
    """Whether one of these containers is from Ansible."""
    return any(found and _label(found) is None for found in (inspect(engine, name) for name in names))


def _label(found: Any) -> str | None:
    """Of a container that the engine has told of: what it was made from."""
    label: str | None = (found["Config"]["Labels"] or {}).get(LABEL)
    return label


def _tidy_images(engine: Engine, store: Store, versions: Collection[str]) -> None:
    """Remove the game's images that none of these versions runs."""
    there = {*versions} & {*store.stored(), store.own}
    used: set[str] = set()
    for version in there:
        with suppress(ValueError):  # what is damaged runs no image
            used |= {container["Image"] for container in store.described(version).values()}
    names = {image.partition(":")[0] for image in used}
    for image in do(engine, "GET", "/images/json"):
        for tag in image["RepoTags"] or ():
            if tag.partition(":")[0] in names and tag not in used:
                engine.ask("DELETE", f"/images/{tag}")  # refused if a container that is not the card's runs it


if __name__ == "__main__":
    sys.exit(main())
