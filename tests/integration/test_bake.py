"""ci/bake: a build that fails is tried once more."""

import os
import subprocess
from pathlib import Path

import pytest

from tests.support.programs import ROOT

ENGINE = """#!/bin/sh
echo "$@" >>"$CALLS"
[ "$(wc -l <"$CALLS")" -gt "$FAILURES" ] || exit 17
"""


@pytest.mark.parametrize(("failures", "tries", "code"), [(0, 1, 0), (1, 2, 0), (2, 2, 17)])
def test_a_failure_is_tried_once_more(failures: int, tries: int, code: int, tmp_path: Path) -> None:
    (tmp_path / "docker").write_text(ENGINE)
    (tmp_path / "docker").chmod(0o755)
    calls = tmp_path / "calls"
    result = subprocess.run(
        [ROOT / "ci/bake", "--set=*.context=a b", "sim"],
        env={"PATH": f"{tmp_path}:{os.defpath}", "CALLS": str(calls), "FAILURES": str(failures)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert result.returncode == code
    call = "buildx bake -f docker-bake.hcl -f ci/prepared.hcl --set=*.context=a b sim"
    assert calls.read_text().splitlines() == [call] * tries
    assert ("once more" in result.stderr) == (tries > 1)
