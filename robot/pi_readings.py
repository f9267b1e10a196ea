"""How the Raspberry Pi is, as its kernel tells it: no program is started, and no right is needed."""

import contextlib
from pathlib import Path

UNDER_VOLTAGE_NOW = 0x1  # bit of the firmware's word


class PiReadings:
    """Read again and again. What this machine does not tell reads as nothing."""

    def __init__(self, proc: Path = Path("/proc"), sys: Path = Path("/sys")) -> None:
        self._proc = proc
        self._sys = sys
        self._busy, self._all = self._ticks()

    @classmethod
    def none(cls) -> "PiReadings":
        """Of a robot without a Raspberry Pi: this machine is not on it."""
        return cls(Path("/dev/null"), Path("/dev/null"))

    def cpu(self) -> float:
        """Load since the last question, 0 to 1 of all cores."""
        busy, total = self._ticks()
        passed, worked = total - self._all, busy - self._busy
        self._busy, self._all = busy, total
        return min(1.0, max(0.0, worked / passed)) if passed > 0 else 0.0

    def temperature(self) -> float:
        """Of the chip, degrees Celsius; 0: unknown."""
        return _whole(self._sys / "class/thermal/thermal_zone0/temp") / 1000

    def wifi(self) -> int:
        """Signal in dBm; 0: no Wi-Fi."""
        for line in _text(self._proc / "net/wireless").splitlines()[2:]:
            words = line.split()
            with contextlib.suppress(ValueError, IndexError):
                level = int(float(words[3].rstrip(".")))
                if -128 <= level < 0:
                    return level
        return 0

    def under_voltage(self) -> bool:
        """Whether the supply is too low now: by the kernel's driver rpi_volt, or by a file of older kernels."""
        for name in sorted((self._sys / "class/hwmon").glob("hwmon*/name")):
            if _text(name).strip() == "rpi_volt":
                return _whole(name.with_name("in0_lcrit_alarm")) == 1
        word = _text(self._sys / "devices/platform/soc/soc:firmware/get_throttled").strip()
        with contextlib.suppress(ValueError):
            return bool(int(word, 16) & UNDER_VOLTAGE_NOW)
        return False

    def _ticks(self) -> tuple[int, int]:
        """Of all cores since the start: working, and in all."""
        words = _text(self._proc / "stat").partition("\n")[0].split()[1:9]
        with contextlib.suppress(ValueError, IndexError):
            ticks = [int(word) for word in words]  # user, nice, system, idle, iowait, irq, softirq, steal
            return sum(ticks) - ticks[3] - ticks[4], sum(ticks)
        return 0, 0


def _text(path: Path) -> str:
    try:
        return path.read_text(errors="replace")
    except OSError:
        return ""


def _whole(path: Path) -> int:
    with contextlib.suppress(ValueError):
        return int(_text(path))
    return 0
