"""`make scale` drives a whole master."""

import re
import subprocess

import pytest

from tests.support.programs import ROOT


@pytest.mark.slow
def test_all_commands_of_three_players_reach_their_robots() -> None:
    command = [str(ROOT / "ci" / "scale"), "--players", "3", "--spectators", "3", "--seconds", "2"]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr
    row = re.search(r"^ +3 .* (\d+) of (\d+) ", run.stdout, re.MULTILINE)
    assert row, run.stdout
    lost, sent = map(int, row.groups())
    assert lost == 0
    assert sent > 100
