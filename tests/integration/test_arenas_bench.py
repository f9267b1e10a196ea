"""`ci/arenas` measures what one database and one entrance carry: in small, all of it works."""

import re
import subprocess

import pytest

from tests.support.programs import ROOT


@pytest.mark.slow
def test_every_line_of_the_table_has_figures_and_nothing_fails() -> None:
    command = [str(ROOT / "ci" / "arenas"), "--arenas=2", "--battles=200", "--visitors=20", "--seconds=3"]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr
    rows = re.findall(r"^(\S.*?) +(\d+)  p50", run.stdout, re.MULTILINE)
    assert len(rows) == 6, run.stdout
    assert all(int(count) > 0 for _, count in rows)
    assert "; 0 requests failed" in run.stdout
