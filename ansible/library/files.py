#!/usr/bin/python3
"""An Ansible module: several files in one step."""

import os
from typing import Any

from ansible.module_utils.basic import AnsibleModule

DOCUMENTATION = """
module: files
short_description: Writes several files
description:
  - Writes those of the files that are not yet as they should be, and makes their folders. That is one step on the host,
    where M(ansible.builtin.copy) needs two for each file.
options:
  files:
    description: The files.
    type: list
    elements: dict
    required: true
    suboptions:
      path:
        description: Where it is.
        type: path
        required: true
      content:
        description: What it holds. Without it, the path is a folder.
        type: str
      once:
        description: Whether it belongs to the host from then on. A file that is there keeps its content.
        type: bool
        default: false
      mode:
        description: Its mode. The default is 0755 for a folder, else 0644.
        type: str
      owner:
        description: Its user and group, by number. Without it, they stay as they are.
        type: int
      validate:
        description: A command that fails if the content is wrong; it finds it in the file %s.
        type: str
author: LaserBot Battle
"""
EXAMPLES = """
- name: Configure the program
  files:
    files:
      - {path: /etc/program.conf, content: "speed=1\\n"}
      - {path: /etc/program, mode: "0700"}
"""

FILE = {
    "path": {"type": "path", "required": True},
    "content": {"type": "str"},
    "once": {"type": "bool", "default": False},
    "mode": {"type": "str"},
    "owner": {"type": "int"},
    "validate": {"type": "str"},
}


def read(path: str) -> bytes | None:
    """What is in the file; None if it is none of its own."""
    if os.path.islink(path) or not os.path.isfile(path):
        return None
    with open(path, "rb") as file:
        return file.read()


def make_folder(module: AnsibleModule, path: str) -> bool:
    """With those above it; says whether it was missing."""
    if os.path.isdir(path):
        return False
    make_folder(module, os.path.dirname(path))
    if not module.check_mode:
        os.mkdir(path)
        os.chmod(path, 0o755)  # whatever the umask
    return True


def write(module: AnsibleModule, file: dict[str, Any]) -> None:
    """The file with its content. Fails the module if the content is wrong."""
    draft = os.path.join(module.tmpdir, "draft")
    with open(draft, "w", encoding="utf-8") as opened:
        opened.write(file["content"])
    if file["validate"]:
        code, said, complaint = module.run_command(file["validate"] % draft)
        if code:
            module.fail_json(msg=f"{file['path']} would be wrong: {said}{complaint}")
    module.atomic_move(draft, file["path"])


def bring_up_to_date(module: AnsibleModule, file: dict[str, Any], diffs: list[dict[str, str]]) -> bool:
    """Whether something was or would be changed."""
    path, content = file["path"], file["content"]
    if content is None:
        path = os.path.realpath(path)  # a folder may be a link to another disk
    changed = make_folder(module, path if content is None else os.path.dirname(path))
    if content is not None:
        before = read(path)
        if before is None or (before != content.encode() and not file["once"]):
            changed = True
            diffs.append(
                {
                    "before": (before or b"").decode(errors="replace"),
                    "after": content,
                    "before_header": path,
                    "after_header": path,
                }
            )
            if not module.check_mode:
                write(module, file)
    if os.path.exists(path):
        changed = module.set_mode_if_different(path, file["mode"] or ("0755" if content is None else "0644"), changed)
        changed = module.set_owner_if_different(path, file["owner"], changed)
        changed = module.set_group_if_different(path, file["owner"], changed)
    return changed


def main() -> None:
    """The module."""
    files = {"type": "list", "elements": "dict", "required": True, "options": FILE}
    module = AnsibleModule({"files": files}, supports_check_mode=True)
    diffs: list[dict[str, str]] = []
    changed = [bring_up_to_date(module, file, diffs) for file in module.params["files"]]
    module.exit_json(changed=any(changed), diff=diffs)


if __name__ == "__main__":
    main()
