"""Client programs of other people's libraries: each prints {"name": value} per step."""

import json
from typing import Any

from tests.support.programs import Program


def told_by(program: Program) -> dict[str, Any]:
    """All that a client program has told, after its successful end."""
    try:
        code = program.exit_code(60)
    finally:
        program.kill()
    assert code == 0, program.output
    told: dict[str, Any] = {}
    for line in program.output.splitlines():
        if line.startswith("{"):  # libraries have words of their own
            told.update(json.loads(line))
    return told
