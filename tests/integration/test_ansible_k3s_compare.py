"""ansible/tasks/k3s_compare.yml: k3s.yml compares what runs with what was built, in each namespace of the game."""

import json
from pathlib import Path

import pytest

from tests.support.archive import Archive
from tests.support.local_play import play_tasks, recap
from tests.support.programs import ROOT

K3S = """#!/bin/sh
cat {folder}/found.json
"""


def play(folder: Path, arena: Archive, entrance: Archive) -> tuple[str, int]:
    """What the play says of a cluster with images of these archives, and how often it has failed."""
    (folder / "k3s").write_text(K3S.format(folder=folder))
    (folder / "k3s").chmod(0o755)
    pods = [
        {
            "metadata": {"namespace": namespace, "name": "one"},
            "spec": {"containers": [{"name": "web", "image": "webserver"}]},
            "status": {"containerStatuses": [{"name": "web", "imageID": archive.digests["webserver"]}]},
        }
        for namespace, archive in (("laserbot-red", arena), ("laserbot-entrance", entrance))
    ]
    (folder / "found.json").write_text(json.dumps({"items": pods}))
    variables = f"k3s_root: {ROOT}\nfleet_images_archive: {folder}/built.tar\n"
    variables += "k3s_namespaces: [laserbot-red, laserbot-entrance, own]\n"
    run = play_tasks(ROOT / "ansible/tasks/k3s_compare.yml", variables, folder, "laser_bot_master")
    return run.stdout, recap(run.stdout)["laser_bot_master"]["failed"]


@pytest.mark.slow
def test_an_entrance_that_is_older_than_its_arenas_is_named(tmp_path: Path) -> None:
    built = Archive(tmp_path / "built.tar")
    older = Archive(tmp_path / "older.tar", {"webserver": "older"})
    said, failed = play(tmp_path, built, older)
    assert failed == 1
    assert f"laserbot-entrance/one web: runs {older.digests['webserver']}" in said
    assert "laserbot-red/one" not in said
    assert play(tmp_path, built, built)[1] == 0
