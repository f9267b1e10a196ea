"""roles/fleet/tasks/service.yml: a service runs with the settings of now, whatever became of the runs before."""

from pathlib import Path

import pytest

from tests.support.local_play import play_role, recap

SYSTEMCTL = """#!/bin/sh
# a service that can be active or not; what it is told is noted
case "$*" in
"is-active game") [ -e {0}/active ] ;;
"is-enabled game") ;;
*)
    echo "$*" >>{0}/told
    [ "$1" != restart ] || [ ! -e {0}/broken ] || exit 1
    [ "$1" != restart ] || touch {0}/active
    ;;
esac
"""
STARTED_ANEW = ["enable game", "restart game"]


class Service:
    """The service `game` with one file of settings."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.settings = folder / "game.conf"
        self.settings.write_text("speed=1\n")
        (folder / "systemctl").write_text(SYSTEMCTL.format(folder))
        (folder / "systemctl").chmod(0o755)

    def run(self, *flags: str) -> tuple[int, list[str]]:
        """What the playbook says to have changed, and what systemctl was told."""
        told = self.folder / "told"
        told.write_text("")
        variables = (
            f"fleet_started: {self.folder}/started\nfleet_services: [{{name: game, files: [{self.settings}]}}]\n"
        )
        run = play_role("fleet", "service", variables, self.folder, "laser_bot_master", *flags)
        row = recap(run.stdout)["laser_bot_master"]
        assert row["failed"] == 0 or (self.folder / "broken").exists(), run.stdout
        return row["changed"], told.read_text().splitlines()


@pytest.fixture
def service(tmp_path: Path) -> Service:
    return Service(tmp_path)


def test_it_is_started_anew_only_with_other_settings(service: Service) -> None:
    assert service.run() == (1, STARTED_ANEW)
    assert service.run() == (0, [])
    service.settings.write_text("speed=2\n")
    assert service.run("--check") == (0, []), "a dry run"
    assert service.run() == (1, STARTED_ANEW)
    assert service.run() == (0, [])


@pytest.mark.slow
def test_it_is_started_anew_after_its_settings_were_others_meanwhile(service: Service) -> None:
    """By hand: the file is as it was, and the service may run with what stood there in between."""
    service.run()
    settings = service.settings.read_text()
    service.settings.write_text("speed=3\n")
    service.settings.write_text(settings)
    assert service.run() == (1, STARTED_ANEW)


def test_what_has_failed_or_was_broken_off_is_made_up_for(service: Service) -> None:
    (service.folder / "broken").touch()
    assert service.run() == (0, STARTED_ANEW)
    (service.folder / "broken").unlink()
    assert service.run() == (1, STARTED_ANEW)


@pytest.mark.slow
def test_one_that_does_not_run_is_started(service: Service) -> None:
    service.run()
    (service.folder / "active").unlink()
    assert service.run() == (1, STARTED_ANEW)
