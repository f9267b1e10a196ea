"""Knobs of the fleet that are refused before anything is done."""

from pathlib import Path

import pytest

from tests.support.local_play import play_role, recap

GOOD = 'fleet_control_networks: ["192.0.2.1/32"]\nfleet_registry_password: long enough for it\n'


@pytest.mark.parametrize(
    ("tasks", "knob", "words"),
    [
        ("facts", "fleet_registry_password: too short", "of at least 12 characters"),
        ("facts", "fleet_control_networks: []", "fleet_control_networks"),
        ("images", "fleet_images_archive: build/images.tar", "must be an absolute path"),
    ],
)
def test_a_wrong_knob_is_refused(tasks: str, knob: str, words: str, tmp_path: Path) -> None:
    run = play_role("fleet", tasks, GOOD + knob, tmp_path)
    assert run.returncode != 0
    assert words in run.stdout
    assert all(row["changed"] == 0 for row in recap(run.stdout).values())


def test_good_ones_are_not(tmp_path: Path) -> None:
    assert play_role("fleet", "facts", GOOD, tmp_path).returncode == 0
