"""Updates: rolling, never in a battle, back by themselves."""

import json
import shutil
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from fleet import Machine
from tests.support.containers import engine
from tests.support.play import PLAYING, STOPPED, hunt_down, obeys, reconnect, shoot_to_the_end, stands_still, start
from tests.support.player import Eyes, Player
from tests.support.polling import until
from tests.support.programs import ROOT
from tests.support.rehearsal import FOLDER, Playbook, Rehearsal, cut, power_off, power_on

pytestmark = pytest.mark.slow

Measured = Callable[[str], None]
VERSION = ElementTree.parse(ROOT / "laser_bot_battle" / "package.xml").findtext("version")
PLATFORMS = {"webserver": "linux/amd64", "rosberry": "linux/amd64,linux/arm/v7"}
FIRMWARE = "/opt/laserbot/firmware/laserbot.hex"


@contextmanager
def archive(tag: str, changed: str, *lines: str) -> Iterator[Path]:
    """An archive in which one image is changed by these lines of a Dockerfile, and the other as it is."""
    (other,) = PLATFORMS.keys() - {changed}
    folder = FOLDER / tag
    folder.mkdir(exist_ok=True)
    try:
        (folder / "Dockerfile").write_text("\n".join([f"FROM {changed}:{VERSION}", *lines, ""]))
        options = [f"--platform={PLATFORMS[changed]}", "--provenance=false", f"--tag={changed}:{tag}"]
        for words in (
            ["build", *options, str(folder)],
            ["save", f"--output={folder}/images.tar", f"{changed}:{tag}", f"{other}:{VERSION}"],
        ):
            subprocess.run(["docker", *words], check=True, capture_output=True)
        engine().images.remove(f"{changed}:{tag}")
        yield folder / "images.tar"
    finally:
        shutil.rmtree(folder)


@pytest.fixture(scope="module")
def better(rehearsal: Rehearsal) -> Iterator[Path]:
    """The master's part of the update has been done: a --limit that leaves the master out needs that."""
    with archive("better", "rosberry", "LABEL better=yes") as file:
        rehearsal.playbook("update", "--limit=master", f"--extra-vars=fleet_images_archive={file}")
        yield file


@pytest.fixture(scope="module")
def broken(rehearsal: Rehearsal) -> Iterator[Path]:
    """A robot's program that is not there, and another firmware: with a byte where there was none."""
    firmware = engine().containers.run(f"rosberry:{VERSION}", [FIRMWARE], entrypoint="cat", remove=True).decode()
    other = ["COPY <<END " + FIRMWARE, ":01700000AAE5", firmware.strip(), "END"]
    with archive("broken", "rosberry", *other, 'CMD ["python3", "-m", "robot.no_such_program"]') as file:
        yield file


@pytest.fixture
def better_master(rehearsal: Rehearsal) -> Iterator[Path]:
    with archive("better-master", "webserver", "LABEL better=yes") as file:
        yield file


@pytest.fixture
def broken_master(rehearsal: Rehearsal) -> Iterator[Path]:
    """ROS master and rosbridge work; the web server, the last to start, is a list of hosts instead of a program."""
    program = "/opt/laserbot/server/main/__init__.py"
    with archive("broken-master", "webserver", f"COPY <<END {program}", "laser_bot_master:", "END") as file:
        yield file


def images(machines: list[Machine]) -> list[str]:
    return [machine.container(machine.services[0])["Config"]["Image"] for machine in machines]


def runs(machine: Machine) -> list[str]:
    """As images(), while they may be replaced."""
    return machine.host.run(f"docker inspect --format '{{{{.Config.Image}}}}' {machine.services[0]}").stdout.split()


def changed(machines: list[Machine], old: list[str]) -> list[bool]:
    """Which of them have another image than before."""
    return [now != before for now, before in zip(images(machines), old, strict=True)]


def test_the_master_gets_a_new_image_and_goes_back(
    rehearsal: Rehearsal, better_master: Path, measured: Measured
) -> None:
    """All of its services, but not while a battle is on; the robots come back to the new ones by themselves."""
    services = rehearsal.master.services

    def running() -> list[str]:
        return [rehearsal.master.container(service)["Config"]["Image"] for service in services]

    old, robots = running(), images(rehearsal.robots)
    update = ("update", f"--extra-vars=fleet_images_archive={better_master}")
    measured("")
    rehearsal.playbook(*update)
    measured("master updated, robots left as they are")
    assert set(running()).isdisjoint(old)
    assert images(rehearsal.robots) == robots
    rehearsal.wait_until_complete()
    measured("all robots are back")
    with Player(rehearsal, "Ann") as ann, Player(rehearsal, "Bob") as bob:
        start(ann, bob)
        number = ann.look()["battle"]
        for playbook in (update, ("reboot",), ("rollback",)):
            run = rehearsal.playbook(*playbook, "--limit=master", "--extra-vars=fleet_battle_patience=4", check=False)
            assert run.recap["laser_bot_master"]["failed"] == 1, run.output
            assert (ann.look()["game"], ann.look()["battle"]) == (PLAYING, number)
    rehearsal.playbook("rollback", "--limit=master")
    assert running() == old
    rehearsal.wait_until_complete()


def test_a_new_image_of_the_master_between_two_hits_ends_no_battle(
    rehearsal: Rehearsal, players: tuple[Player, Player], better_master: Path, measured: Measured
) -> None:
    """A deployment does not wait for the end of the battle: ROS master, rosbridge and web server are all replaced."""
    ann, bob = players
    with Eyes(rehearsal) as eyes:
        start(ann, bob)
        hunt_down(ann, bob, eyes, 60)
        stands_still(ann, eyes)
        before = ann.look()
        old = rehearsal.master.container("laserbot-web")["Id"]
        deploy = Playbook("deploy", "--limit=master", f"--extra-vars=fleet_images_archive={better_master}")
        measured("")
        until(lambda: rehearsal.available() < 0 or not deploy.running, 900, "the web server goes")
        measured("master deployed up to the battle's interruption")
        until(lambda: rehearsal.available() >= 0, 60, "the web server is back")
        measured("the web server was away for the first time")
        deploy.finish()
        assert rehearsal.master.container("laserbot-web")["Id"] != old
        for player in players:
            reconnect(player)
            player.wait_for_game(PLAYING)
        measured("all replaced, and the pages are back")
        after = ann.look()
        assert after["battle"] == before["battle"]
        assert after["time_left"] < before["time_left"]
        assert lives(after) == lives(before)
        assert lives(after)["Bob"] in (60, 20), "the hunter may have hit once more than it meant to"
        assert [player.ready() for player in players] == ["STARTED", "STARTED"], "they are signed in"
        for player in players:
            obeys(player, eyes, 60)
        measured("the robots obey again")
        assert shoot_to_the_end(ann, bob, eyes)[-1] == 0
    rehearsal.playbook("rollback", "--limit=master")


def lives(status: dict[str, Any]) -> dict[str, int]:
    return {user["name"]: user["life"] for user in status["users"]}


def test_robots_get_a_new_image_and_go_back(rehearsal: Rehearsal, better: Path, measured: Measured) -> None:
    """But for one that is off: it is left out by the update, and has nothing to go back from."""
    update = ("update", f"--extra-vars=fleet_images_archive={better} batch=2")
    absent, *others = rehearsal.robots
    old = images(rehearsal.robots)
    dry = rehearsal.playbook(*update, "--check", "--diff")
    assert all(row["failed"] == 0 for row in dry.recap.values())
    assert images(rehearsal.robots) == old

    power_off(absent)
    try:
        measured("")
        run = rehearsal.playbook(*update)
        measured("updated, two at a time, a third one is off")
    finally:
        power_on(absent)
    assert f"{absent.name} is off and keeps its image" in run.output
    new = images(others)
    assert len(set(new)) == 1
    assert set(new).isdisjoint(old)
    rehearsal.wait_until_complete()
    measured("")
    rehearsal.playbook("rollback")
    measured("rolled back")
    assert images(rehearsal.robots) == old
    rehearsal.wait_until_complete()


def test_a_rollback_that_was_broken_off_is_ended_by_the_next(rehearsal: Rehearsal, better: Path) -> None:
    first = rehearsal.robots[0]
    old = images([first])
    rehearsal.playbook("update", f"--extra-vars=fleet_images_archive={better}", f"--limit={first.name}")
    assert images([first]) != old
    broken_off = Playbook("rollback", f"--limit={first.name}")
    until(lambda: runs(first) == old, 200, "it has the image from before")
    broken_off.stop(signal.SIGINT, 60)
    for _ in range(2):  # the second has nothing to do
        rehearsal.playbook("rollback", f"--limit={first.name}")
        assert images([first]) == old
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


def test_no_robot_is_drawn_into_a_battle_meanwhile(
    rehearsal: Rehearsal, players: tuple[Player, Player], better: Path
) -> None:
    """One was free when it was asked for, but others of its batch were not: the next battle waits for them all."""
    ann, bob = players
    old = images(rehearsal.robots)
    variables = f"fleet_images_archive={better} batch=3 max_fail=100 fleet_battle_patience=16"
    with Player(rehearsal, "Cy") as cy:
        hosts = {player.name: rehearsal.machines[f"raspberrypi{player.robot}"].name for player in (ann, bob, cy)}
        start(ann, bob)
        run = Playbook("update", "--limit=robots", f"--extra-vars={variables}")
        run.wait_for("TASK [fleet : Ask the server", 200)
        until(lambda: f"ok: [{hosts['Cy']}" in run.output.rpartition("TASK [fleet : Ask")[2], 30, "Cy's robot is free")
        bob.post("signOutUser", data=bob.name)
        ann.wait_for_game(STOPPED)
        for player in (ann, cy):
            player.post("playerReady", user=player.name, ready="1")
        assert ann.look()["game"] == STOPPED
        run.finish()
    assert changed(rehearsal.robots, old) == [True] * len(rehearsal.robots)
    rehearsal.playbook("rollback", "--extra-vars=fleet_battle_patience=400")
    assert images(rehearsal.robots) == old


def test_one_that_fails_keeps_the_update_from_the_next(rehearsal: Rehearsal, better: Path) -> None:
    """Of a batch of two, unless half of them may fail."""
    first, *_ = rehearsal.robots
    old = images(rehearsal.robots)
    variables = f"fleet_images_archive={better} batch=2"
    first.run("systemctl stop virtual-arduino")
    try:
        run = rehearsal.playbook("update", f"--extra-vars={variables}", check=False)
        assert {name for name, row in run.recap.items() if row["failed"]} == {first.name}, run.output
        assert changed(rehearsal.robots, old) == [False, True, False]
        rehearsal.playbook("update", f"--extra-vars={variables} max_fail=50", check=False)
        assert changed(rehearsal.robots, old) == [False, True, True]
    finally:
        first.run("systemctl start virtual-arduino")
    rehearsal.playbook("rollback")
    assert images(rehearsal.robots) == old
    rehearsal.wait_until_complete()


def test_one_that_is_lost_keeps_the_update_from_the_next(
    rehearsal: Rehearsal, better: Path, measured: Measured
) -> None:
    first, _, third = rehearsal.robots
    old = images(rehearsal.robots)
    run = Playbook("update", f"--extra-vars=fleet_images_archive={better} batch=2")
    try:
        run.wait_for("TASK [robot :", 200)
        with cut(first):  # a plug takes no leave: no connection is closed
            measured("")
            until(lambda: f"fatal: [{first.name}]: UNREACHABLE!" in run.output, 120, "the robot is given up")
            measured("given up")
        power_off(first)
        run.finish(check=False)
    finally:
        power_on(first)
    assert f"{first.name} failed or cannot be reached" in run.output
    assert images([third]) == old[2:]
    rehearsal.wait_until_complete()
    rehearsal.playbook("rollback")
    assert images(rehearsal.robots) == old
    rehearsal.wait_until_complete()


def stored(machine: Machine) -> set[str]:
    """The fleet's images on the host."""
    return set(machine.run("docker image ls --digests --format '{{.Repository}}@{{.Digest}}' '*:5443/*'").split())


def test_an_update_that_was_broken_off_while_it_flashed_is_rolled_back(rehearsal: Rehearsal, broken: Path) -> None:
    """Its service is stopped, with the image that it had, and the Arduino holds half a program or another one."""
    first = rehearsal.robots[0]
    old, flashed = images([first]), first.run("cat /etc/laserbot/firmware.json")
    broken_off = Playbook("update", f"--extra-vars=fleet_images_archive={broken}")
    broken_off.wait_for("TASK [firmware : Write and verify the firmware", 400)
    broken_off.stop(signal.SIGINT, 60)
    assert not first.container("laserbot-robot")["State"]["Running"]
    rehearsal.playbook("rollback", f"--limit={first.name}")
    assert images([first]) == old
    assert first.run("cat /etc/laserbot/firmware.json") == flashed
    rehearsal.wait_until_complete()


def test_an_image_that_does_not_start_is_refused_though_the_update_was_broken_off(
    rehearsal: Rehearsal, broken: Path, measured: Measured
) -> None:
    old = images(rehearsal.robots)
    first = rehearsal.robots[0]
    noted_before, flashed = noted(first), first.run("cat /etc/laserbot/firmware.json")
    broken_off = Playbook("update", f"--extra-vars=fleet_images_archive={broken}")
    until(lambda: runs(first) not in ([], old[:1]), 400, "it has the new image")
    broken_off.stop(signal.SIGINT, 60)
    assert json.loads(first.run("cat /etc/laserbot/firmware.json"))["sum"] != json.loads(flashed)["sum"]
    rehearsal.playbook("rollback", f"--limit={first.name}")
    assert images([first]) == old[:1], "not the one before the last that worked"
    assert first.run("cat /etc/laserbot/firmware.json") == flashed

    measured("")
    run = rehearsal.playbook(
        "update", f"--extra-vars=fleet_images_archive={broken} fleet_health_timeout=20", check=False
    )
    measured("refused by the first robot, the others left alone")
    assert run.process.returncode != 0
    assert sum(row["failed"] for row in run.recap.values()) == 1
    assert "No module named robot.no_such_program" in run.output, "what the service said"
    assert f"runs with {old[0]} again" in run.output
    assert images(rehearsal.robots) == old
    assert first.run("cat /etc/laserbot/firmware.json") == flashed
    assert noted(first) == noted_before
    rehearsal.playbook("rollback")
    assert images(rehearsal.robots) == old, "nobody has got the newest release: nothing to go back from"
    rehearsal.wait_until_complete()
    assert stored(first) == {noted_before["current"], noted_before["previous"]} - {""}, "the refused one takes no room"


def noted(machine: Machine) -> dict[str, str]:
    """What the host remembers of its releases, without the one that it was offered last."""
    known: dict[str, str] = json.loads(machine.run("cat /etc/laserbot/release.json"))
    return {key: value for key, value in known.items() if key != "offered"}


def test_a_masters_image_is_refused_as_a_whole(rehearsal: Rehearsal, broken_master: Path, measured: Measured) -> None:
    old = [rehearsal.master.container(service)["Config"]["Image"] for service in rehearsal.master.services]
    measured("")
    run = rehearsal.playbook(
        "update", f"--extra-vars=fleet_images_archive={broken_master} fleet_health_timeout=20", check=False
    )
    measured("refused by the web server, all three services back")
    assert run.recap["laser_bot_master"]["failed"] == 1
    assert [rehearsal.master.container(one)["Config"]["Image"] for one in rehearsal.master.services] == old
    rehearsal.wait_until_complete()


@pytest.fixture
def older_master(rehearsal: Rehearsal) -> Iterator[Path]:
    """The webserver of a release that had no bots."""
    with archive("older-master", "webserver", "USER root", "RUN rm -r /opt/laserbot/server/bots", "USER 10001") as file:
        yield file


def test_the_master_goes_back_to_a_release_that_lacks_a_program(rehearsal: Rehearsal, older_master: Path) -> None:
    """Without that program's service, whatever the inventory sets for it; the newer release brings it again."""
    master = rehearsal.master

    def running() -> dict[str, str]:
        names = master.run("docker ps --filter name=^/laserbot- --format '{{.Names}}'").split()
        return {name: container["Config"]["Image"] for name, container in master.containers(*names).items()}

    now = running()
    rehearsal.playbook("update", f"--extra-vars=fleet_images_archive={older_master}")
    older = running()
    assert now.keys() - older.keys() == {"laserbot-bots"}
    assert set(now.values()).isdisjoint(older.values())
    rehearsal.playbook("update")
    assert running() == now
    rehearsal.playbook("rollback", "--extra-vars=master_bot_robots=1")
    assert running() == older
    rehearsal.playbook("update")
    assert running() == now
    rehearsal.wait_until_complete()


def test_a_robot_that_missed_a_release_goes_back_by_one_as_the_others(rehearsal: Rehearsal, better: Path) -> None:
    """It was off when one came, and on when the next did. The registry has what they go back to, and no more."""
    absent, other = rehearsal.robots[:2]
    old = images([absent, other])
    power_off(absent)
    try:
        rehearsal.playbook("update", f"--extra-vars=fleet_images_archive={better}")
    finally:
        power_on(absent)
    rehearsal.wait_until_complete()
    missed = images([other])
    with archive("best", "rosberry", "LABEL best=yes") as file:
        rehearsal.playbook("update", f"--extra-vars=fleet_images_archive={file}")
        newest = images([absent, other])
        assert not {*newest} & {*old, *missed}
        assert in_the_registry(rehearsal.master, "rosberry") == {one.partition("@")[2] for one in newest + missed}
        rehearsal.playbook("rollback")
    assert images([absent, other]) == missed * 2
    rehearsal.playbook("deploy")
    assert images([absent, other]) == old
    rehearsal.wait_until_complete()


def in_the_registry(master: Machine, name: str) -> set[str]:
    """Digests of an image that the registry can give to a host."""
    ask = f"skopeo inspect --raw --authfile /root/.docker/config.json docker://laser-bot-master.local:5443/{name}@"
    folder = f"/var/lib/docker-registry/docker/registry/v2/repositories/{name}/_manifests/revisions/sha256"
    digests = [f"sha256:{link.split('/')[-2]}" for link in master.run(f"find {folder} -name link").split()]
    return {digest for digest in digests if "manifests" in json.loads(master.run(f"{ask}{digest}"))}
