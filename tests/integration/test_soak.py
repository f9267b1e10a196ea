"""A short evening with faults (`make soak`)."""

import subprocess

import pytest

from tests.support.programs import ROOT


@pytest.mark.slow
def test_after_a_minute_of_faults_nothing_is_left_over_and_all_results_are_right() -> None:
    command = [str(ROOT / "ci" / "soak"), "--minutes", "1", "--seed", "20"]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=1200)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "ok      each result is what its events lead to" in run.stdout
