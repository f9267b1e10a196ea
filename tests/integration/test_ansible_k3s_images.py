"""ansible/k3s.yml: the archive of images is the fleet's own where the inventory names no other."""

from pathlib import Path

import pytest

from tests.support.archive import Archive
from tests.support.local_play import INVENTORY, run_playbook
from tests.support.programs import ROOT


@pytest.mark.slow
def test_the_fleets_own_archive_is_compared_with_the_manifests(tmp_path: Path) -> None:
    """In a work tree that has one. The manifests name none of its images, so that the play ends there."""
    tree = tmp_path / "tree"
    for folder in ("build", "ci"):
        (tree / folder).mkdir(parents=True)
    for folder in ("ansible", "k3s", "laser_bot_battle"):
        (tree / folder).symlink_to(ROOT / folder)
    Archive(tree / "build/images.tar")
    for program, said in ((tmp_path / "k3s", ""), (tree / "ci/kubectl", "image: somebody/elses:1")):
        program.write_text(f"#!/bin/sh\necho '{said}'\n")
        program.chmod(0o755)
    (tmp_path / "hosts.yml").write_text(INVENTORY)
    variables = f"ansible_become=false k3s_archive={tmp_path}/nodes/images.tar"
    run = run_playbook(tree / "ansible/k3s.yml", variables, tmp_path, "laser_bot_master")
    assert "the manifests name none of" in " ".join(run.stdout.split()), run.stdout
