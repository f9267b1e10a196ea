"""Updates: rolling, never in a battle, back by themselves."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.support.fleet import Machine
from tests.support.play import PLAYING, obeys, start
from tests.support.player import Eyes, Player
from tests.support.programs import ROOT
from tests.support.rehearsal import FOLDER, Rehearsal, docker

Measured = Callable[[str], None]
PLATFORMS = "linux/amd64,linux/arm/v7"
VERSION = ElementTree.parse(ROOT / "laser_bot_battle" / "package.xml").findtext("version")


@contextmanager
def archive(tag: str, *lines: str) -> Iterator[Path]:
    """An archive with a changed robot image, and the master's as it is."""
    file, recipe = FOLDER / f"{tag}.tar", FOLDER / f"{tag}.Dockerfile"
    recipe.write_text("\n".join([f"FROM rosberry:{VERSION}", *lines, ""]))
    docker("build", f"--platform={PLATFORMS}", f"--file={recipe}", "--provenance=false", f"--tag=rosberry:{tag}",
           str(FOLDER / "inventory"))  # fmt: skip
    docker("save", f"--output={file}", f"rosberry:{tag}", f"webserver:{VERSION}")
    docker("image", "rm", f"rosberry:{tag}")
    try:
        yield file
    finally:
        file.unlink()
        recipe.unlink()


@pytest.fixture(scope="module")
def better(rehearsal: Rehearsal) -> Iterator[Path]:
    with archive("better", "LABEL better=yes") as file:
        yield file


@pytest.fixture(scope="module")
def broken(rehearsal: Rehearsal) -> Iterator[Path]:
    with archive("broken", 'CMD ["python3", "-m", "robot.no_such_program"]') as file:
        yield file


def images(machines: list[Machine]) -> list[str]:
    return [machine.container(machine.services[0])["Config"]["Image"] for machine in machines]


def test_robots_get_a_new_image_and_go_back(rehearsal: Rehearsal, better: Path, measured: Measured) -> None:
    old = images(rehearsal.robots)
    measured("")
    rehearsal.playbook("update", f"--extra-vars=fleet_images_archive={better} batch=2")
    measured("updated, two at a time")
    new = images(rehearsal.robots)
    assert len(set(new)) == 1
    assert set(new).isdisjoint(old)
    rehearsal.wait_until_complete()
    measured("")
    rehearsal.playbook("rollback", "--limit=robots")
    measured("rolled back")
    assert images(rehearsal.robots) == old
    rehearsal.wait_until_complete()


def test_an_update_leaves_robots_in_a_battle_alone(
    rehearsal: Rehearsal, players: tuple[Player, Player], better: Path
) -> None:
    ann, bob = players
    fighting = [rehearsal.machines[f"raspberrypi{player.robot}"] for player in players]
    [third] = [robot for robot in rehearsal.robots if robot not in fighting]
    old = images([*fighting, third])
    with Eyes(rehearsal) as eyes:
        start(ann, bob)
        number = ann.look()["battle"]
        run = rehearsal.playbook(
            "update",
            "--limit=robots",
            f"--extra-vars=fleet_images_archive={better} batch=3 max_fail=100 fleet_battle_patience=4",
            check=False,
        )
        assert {name for name, row in run.recap.items() if row["failed"]} == {machine.name for machine in fighting}, (
            run.output
        )
        assert images(fighting) == old[:2]
        assert images([third]) != old[2:]
        obeys(ann, eyes)
        assert (ann.look()["game"], ann.look()["battle"]) == (PLAYING, number)
    rehearsal.playbook("rollback", f"--limit={third.name}", "--extra-vars=fleet_battle_patience=400")
    assert images([third]) == old[2:]


def test_an_image_that_does_not_start_is_refused(rehearsal: Rehearsal, broken: Path, measured: Measured) -> None:
    old = images(rehearsal.robots)
    release = rehearsal.robots[0].run("cat /etc/laserbot/release.json")
    measured("")
    run = rehearsal.playbook(
        "update", f"--extra-vars=fleet_images_archive={broken} fleet_health_timeout=20", check=False
    )
    measured("refused by the first robot, the others left alone")
    assert run.process.returncode != 0
    assert sum(row["failed"] for row in run.recap.values()) == 1
    assert "runs with" in run.output
    assert images(rehearsal.robots) == old
    assert rehearsal.robots[0].run("cat /etc/laserbot/release.json") == release
    rehearsal.wait_until_complete()
