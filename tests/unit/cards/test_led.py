"""A wrong laserbot.txt is seen without a screen: by the Raspberry Pi's LED."""

from pathlib import Path

import pytest

from cards.led import show


@pytest.fixture
def act(tmp_path: Path) -> Path:
    """The LED, as sysfs has it before a trigger is chosen."""
    (tmp_path / "leds/ACT").mkdir(parents=True)
    (tmp_path / "leds/ACT/trigger").write_text("none [heartbeat] timer\n")
    return tmp_path / "leds/ACT"


def shown(line: str, act: Path, role: str = "robot") -> dict[str, str]:
    boot = act.parents[1]
    (boot / "laserbot.txt").write_text(line)
    show(boot, act.parent, role)
    return {path.name: path.read_text() for path in act.iterdir()}


@pytest.mark.parametrize("line, role", [("role = both", "robot"), ("name = r1", "master")])
def test_a_mistake_blinks_slowly(line: str, role: str, act: Path) -> None:
    assert shown(line, act, role) == {"trigger": "timer", "delay_on": "1000", "delay_off": "1000"}


def test_a_file_without_mistakes_leaves_the_led_alone(act: Path) -> None:
    assert shown("name = r1", act) == {"trigger": "none [heartbeat] timer\n"}


def test_a_card_without_its_file_blinks_too(act: Path) -> None:
    show(act / "no partition", act.parent, "robot")
    assert (act / "trigger").read_text() == "timer"
