"""ansible/README.md says what the roles do."""

import re

from tests.support.programs import ROOT

ANSIBLE = ROOT / "ansible"
README = (ANSIBLE / "README.md").read_text()


def test_every_knob_is_in_the_table_and_no_other() -> None:
    knobs = {
        knob
        for defaults in ANSIBLE.glob("roles/*/defaults/main.yml")
        for knob in re.findall(r"^(\w+):", defaults.read_text(), re.MULTILINE)
    }
    assert set(re.findall(r"^\| `([a-z]+_\w+)` \|", README, re.MULTILINE)) == knobs


def test_every_playbook_is_in_the_table_and_no_other() -> None:
    assert set(re.findall(r"^\| `(\w+\.yml)` \|", README, re.MULTILINE)) == {
        path.name for path in ANSIBLE.glob("*.yml")
    }
