"""What all of ansible/roles must keep to."""

import pytest
import yaml

from tests.support.programs import ROOT

ROLES = ROOT / "ansible" / "roles"
HANDLERS = {path.parts[-3]: yaml.safe_load(path.read_text()) for path in ROLES.glob("*/handlers/main.yml")}
PLAYS = yaml.safe_load((ROOT / "ansible" / "deploy.yml").read_text())


@pytest.mark.parametrize("role", HANDLERS)
def test_what_a_run_that_was_broken_off_left_to_be_restarted_is_restarted(role: str) -> None:
    """By the next run, which finds every file as it should be: each handler listens, and each play with one calls."""
    for handler in HANDLERS[role]:
        assert handler["listen"] == "A run was broken off", handler["name"]
    (play,) = [play for play in PLAYS if role in play.get("roles", [])]
    assert [task["notify"] for task in play["tasks"]] == ["A run was broken off"]
