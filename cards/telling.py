"""laserbot-errors.txt, the file on a card's first partition that says what is wrong. The screen says it, too."""

import sys
from collections.abc import Sequence
from pathlib import Path

from cards.laserbot_txt import Mistake

ERRORS = "laserbot-errors.txt"


def tell(boot: Path, topic: str, problem: str) -> None:
    """Let one line say what is wrong with the topic, or none without a problem. What is there stays."""
    path = boot / ERRORS
    line = " ".join(f"{topic}: {problem}".split())
    try:
        known = path.read_text().splitlines() if path.exists() else []
        if problem and line in known:
            return
        lines = [other for other in known if not other.startswith(f"{topic}: ")] + ([line] if problem else [])
        if not lines:
            path.unlink(missing_ok=True)
        elif lines != known:
            path.write_bytes("".join(f"{other}\r\n" for other in lines).encode())
    except (OSError, ValueError) as error:
        print(f"{path}: cannot be written: {error}", file=sys.stderr)
    if problem:
        print(line, file=sys.stderr)


def tell_mistakes(boot: Path, mistakes: Sequence[Mistake]) -> None:
    """Let those of laserbot.txt be all that is told."""
    path = boot / ERRORS
    for mistake in mistakes:
        print(mistake, file=sys.stderr)
    text = "".join(f"{mistake}\r\n" for mistake in mistakes)
    try:
        if not text:
            path.unlink(missing_ok=True)
        elif not path.exists() or path.read_bytes() != text.encode():
            path.write_bytes(text.encode())
    except OSError as error:
        print(f"{path}: cannot be written: {error.strerror}", file=sys.stderr)
