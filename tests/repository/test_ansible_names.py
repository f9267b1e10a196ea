"""Every variable that a playbook or a role uses is set somewhere: by a role, a playbook, a task or its loop."""

import re

from tests.support.programs import ROOT

ANSIBLE = ROOT / "ansible"
PREFIXES = "|".join(["k3s", "card", *(role.name for role in (ANSIBLE / "roles").iterdir())])
NAME = rf"(?:{PREFIXES})_[a-z0-9_]+"
# a word in the middle of a path, an attribute or another name is none, nor is a template's file
USED = re.compile(rf"(?<![\w./'\"-])({NAME})\b(?![:/-]|\.j2|\.yml)")
SET = re.compile(rf"(?:^|[\s{{])({NAME}):|(?:register|loop_var): ({NAME})", re.MULTILINE)
# given to the command: ansible-playbook -e, or by ci/cards
GIVEN = {"card_image", "card_role", "k3s_backup", "k3s_backup_delay", "k3s_backup_retries", "k3s_overlay"}


def test_every_variable_is_set() -> None:
    files = [path for path in ANSIBLE.rglob("*") if path.suffix in (".yml", ".j2")]
    texts = {path: re.sub(r"(?m)(^|\s)#.*$", "", path.read_text()) for path in files}
    known = {name for text in texts.values() for names in SET.findall(text) for name in names} | GIVEN
    unknown = {f"{path.name}: {name}" for path, text in texts.items() for name in set(USED.findall(text)) - known}
    assert unknown == set()
