"""ansible/tasks/k3s_backup.yml: k3s.yml saves the databases of a cluster before it changes it."""

from pathlib import Path

import pytest

from tests.support.local_play import play_tasks, recap
from tests.support.programs import ROOT

# a cluster with backups in two namespaces; what is made there is noted
K3S = """#!/bin/sh
case "$*" in
*"get cronjobs"*) echo laserbot others ;;
*"create job"*) echo "$*" >>{folder}/made; echo "job.batch/backup-1 created" ;;
*"get job.batch/backup-1"*) cat {folder}/state ;;
esac
"""


def play(folder: Path, state: str, namespaces: str = "[laserbot]") -> tuple[str, int]:
    """What the play says, and how often it has failed; `state` is what becomes of the Job."""
    (folder / "k3s").write_text(K3S.format(folder=folder))
    (folder / "k3s").chmod(0o755)
    (folder / "state").write_text(state)
    variables = f"k3s_namespaces: {namespaces}\nk3s_backup_retries: 2\nk3s_backup_delay: 0\n"
    run = play_tasks(ROOT / "ansible/tasks/k3s_backup.yml", variables, folder, "laser_bot_master")
    return run.stdout, recap(run.stdout)["laser_bot_master"]["failed"]


@pytest.mark.slow
def test_each_database_of_what_is_applied_is_saved(tmp_path: Path) -> None:
    said, failed = play(tmp_path, "SuccessCriteriaMet Complete")
    assert failed == 0, said
    (made,) = (tmp_path / "made").read_text().splitlines()
    assert made.startswith("kubectl --namespace laserbot create job backup-")
    assert made.endswith("--from=cronjob/backup")


@pytest.mark.slow
@pytest.mark.parametrize("state", ["FailureTarget Failed", ""], ids=["it fails", "it takes too long"])
def test_nothing_is_changed_when_that_fails(state: str, tmp_path: Path) -> None:
    said, failed = play(tmp_path, state)
    assert failed == 1
    assert "laserbot could not be saved, and nothing was applied" in " ".join(said.split())


@pytest.mark.slow
def test_a_cluster_without_backups_is_changed_all_the_same(tmp_path: Path) -> None:
    said, failed = play(tmp_path, "", "[elsewhere]")
    assert failed == 0, said
    assert not (tmp_path / "made").exists()
