"""The firmware's own build: its host tests, its size, what it rebuilds, and its words when tools are missing."""

import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def make(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """`make -C firmware` with `arguments`, independent of a make that may be running these tests."""
    outer = {"MAKEFLAGS", "MFLAGS", "MAKELEVEL"}
    environment = {name: value for name, value in os.environ.items() if name not in outer}
    command = ["make", "-C", "firmware", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300, check=False)


def test_all_host_tests_of_the_firmware_pass() -> None:
    result = make("check")
    assert result.returncode == 0, result.stdout + result.stderr
    count = re.search(r"^(\d+) tests, 0 failed$", result.stdout, re.MULTILINE)
    assert count, result.stdout
    print(f"{count[1]} host tests of the firmware")
    assert int(count[1]) == len(re.findall(r"^ok ", result.stdout, re.MULTILINE)) >= 60


def test_the_firmware_builds_within_its_budget_and_only_what_has_changed(tmp_path: Path) -> None:
    first = make(f"BUILD={tmp_path}")
    assert first.returncode == 0, first.stderr
    assert (tmp_path / "laserbot.elf").read_bytes().startswith(b"\x7fELF")
    assert (tmp_path / "laserbot.hex").read_text().endswith(":00000001FF\n")
    assert "warning" not in first.stderr, first.stderr
    sizes = {name: float(share) for name, share in re.findall(r"(flash|RAM) .*\((.*) %\)", first.stdout)}
    assert 0 < sizes["flash"] <= 60
    assert 0 < sizes["RAM"] <= 75

    second = make(f"BUILD={tmp_path}")
    assert second.returncode == 0, second.stderr
    assert ".o\n" not in second.stdout
    assert "laserbot.elf" not in second.stdout


def test_a_missing_arduino_core_is_one_clear_line(tmp_path: Path) -> None:
    result = make(f"BUILD={tmp_path}", "ARDUINO=/nonexistent")
    assert result.returncode != 0
    assert "apt-get install gcc-avr binutils-avr avr-libc arduino-core-avr" in result.stderr
    assert not list(tmp_path.glob("**/*.o"))


def test_a_missing_host_compiler_is_one_clear_line(tmp_path: Path) -> None:
    result = make("check", f"BUILD={tmp_path}", "HOST_CXX=no-such-compiler")
    assert result.returncode != 0
    assert "no-such-compiler is missing" in result.stderr
    assert "apt-get install g++" in result.stderr


def test_a_board_that_there_is_not_is_one_clear_line(tmp_path: Path) -> None:
    result = make(f"BUILD={tmp_path}", "BOARD=mega")
    assert result.returncode != 0
    assert "there is no board mega; use BOARD=uno or BOARD=nano" in result.stderr
