"""ansible/k3s.yml: the archive of images is the fleet's own where the inventory names no other."""

import subprocess
from pathlib import Path

import pytest

from tests.support.archive import Archive
from tests.support.local_play import INVENTORY
from tests.support.programs import ROOT


@pytest.mark.slow
def test_the_fleets_own_archive_is_compared_with_the_manifests(tmp_path: Path) -> None:
    """In a work tree that has one. The manifests name none of its images, so that the play ends there."""
    for folder in ("ansible", "k3s", "laser_bot_battle"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    (tmp_path / "build").mkdir()
    Archive(tmp_path / "build/images.tar")
    programs = tmp_path / "ci"
    programs.mkdir()
    for name, said in (("k3s", ""), ("kubectl", "image: somebody/elses:1")):
        (programs / name).write_text(f"#!/bin/sh\necho '{said}'\n")
        (programs / name).chmod(0o755)
    (tmp_path / "hosts.yml").write_text(INVENTORY)
    run = subprocess.run(
        [
            ROOT / ".venv/bin/ansible-playbook",
            f"--inventory={tmp_path}/hosts.yml",
            "--limit=laser_bot_master",
            f"--extra-vars=ansible_become=false k3s_archive={tmp_path}/nodes/images.tar",
            tmp_path / "ansible/k3s.yml",
        ],
        env={
            "PATH": f"{programs}:/usr/bin:/bin",
            "ANSIBLE_CONFIG": str(ROOT / "ansible/ansible.cfg"),
            "ANSIBLE_HOME": str(tmp_path / "home"),
            "ANSIBLE_LOCAL_TEMP": str(tmp_path / "home/tmp"),
            "ANSIBLE_NOCOLOR": "1",
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert "the manifests name none of" in " ".join(run.stdout.split()), run.stdout
