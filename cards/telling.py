"""laserbot-errors.txt, the file on a card's first partition that says what is wrong. The screen says it, too."""

import re
import sys
from collections.abc import Sequence
from pathlib import Path

from cards.laserbot_txt import Mistake

ERRORS = "laserbot-errors.txt"


def topic_of(version: str) -> str:
    """The topic of a version that was tried, and does not run. Its line stays when the card starts again, as the
    version is tried only once."""
    return f"version {version} does not run here"


def tell(boot: Path, topic: str, problem: str) -> None:
    """Let one line say what is wrong with the topic, or none without a problem. What is there stays."""
    path = boot / ERRORS
    line = " ".join(f"{topic}: {problem}".split())
    try:
        known = _lines(path)
        if problem and line in known:
            return
        others = [other for other in known if not other.startswith(f"{topic}: ")]
        _write(path, known, others + ([line] if problem else []))
    except OSError as error:
        print(f"{path}: cannot be written: {error.strerror}", file=sys.stderr)
    if problem:
        print(line, file=sys.stderr)


def tell_mistakes(boot: Path, mistakes: Sequence[Mistake]) -> None:
    """Replace all that is told by the mistakes in laserbot.txt, but keep what is told of versions that do not run."""
    path = boot / ERRORS
    for mistake in mistakes:
        print(mistake, file=sys.stderr)
    try:
        known = _lines(path)
        of_versions = [line for line in known if re.match(topic_of(r"\S+") + ": ", line)]
        _write(path, known, [*map(str, mistakes), *of_versions])
    except OSError as error:
        print(f"{path}: cannot be written: {error.strerror}", file=sys.stderr)


def _lines(path: Path) -> list[str]:
    return path.read_text(errors="replace").splitlines() if path.exists() else []


def _write(path: Path, known: Sequence[str], lines: Sequence[str]) -> None:
    """OSError if the file cannot be written. What is `known` to be there already is not written again."""
    if not lines:
        path.unlink(missing_ok=True)
    elif lines != known:
        path.write_bytes("".join(f"{line}\r\n" for line in lines).encode())
