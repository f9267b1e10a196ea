"""The GPIO line: the real library where there is no GPIO, and what is written to a line."""

import subprocess
import sys
from pathlib import Path

import pytest
from gpiod.line import Value

from robot.gpio_line import GpioLine, NoLineError
from tests.support.gpio import RecordedRequest
from tests.support.programs import ROOT


def test_active_and_inactive_are_written_to_its_number() -> None:
    request = RecordedRequest()
    line = GpioLine(request, 18)
    line.set(True)
    line.set(False)
    assert request.values == [(18, Value.ACTIVE), (18, Value.INACTIVE)]
    line.release()
    assert request.released


def test_a_missing_chip_is_named(tmp_path: Path) -> None:
    with pytest.raises(NoLineError, match=f"line 18 of {tmp_path}/gpiochip0: .*No such file"):
        GpioLine.active_low(18, f"{tmp_path}/gpiochip0")


def test_a_device_that_is_no_gpio_chip_is_refused() -> None:
    """Compose gives /dev/null to a container whose robot has no GPIO."""
    with pytest.raises(NoLineError, match=r"line 18 of /dev/null: .*No such device"):
        GpioLine.active_low(18, "/dev/null")


def test_a_plain_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(NoLineError, match=r"line 18 of .*Inappropriate ioctl"):
        GpioLine.active_low(18, str(tmp_path / "file"))


@pytest.mark.parametrize("library", ["nothing", "version 1"])
def test_a_missing_or_old_library_is_named(tmp_path: Path, library: str) -> None:
    """Version 1 is one module, so that gpiod.line is not found in it."""
    (tmp_path / "gpiod.py").write_text("" if library == "version 1" else "raise ImportError")
    words = "from robot.gpio_line import GpioLine; GpioLine.active_low(18)"
    result = subprocess.run(
        [sys.executable, "-c", words],
        env={"PYTHONPATH": f"{tmp_path}:{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "NoLineError: the Python library gpiod, version 2, is not installed" in result.stderr
