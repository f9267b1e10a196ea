"""A card and its versions of the game: an update is taken, tried, and left again, whenever the power goes."""

import os
import shutil
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

from cards.archive import manifest_of
from cards.containers import LABEL
from cards.engine import EngineError, Socket
from cards.laserbot_txt import Card
from cards.run import TRIES
from cards.versions import State
from tests.support.updates import CardHost, Cut, image, power, write_update


@pytest.fixture
def master(tmp_path: Path) -> CardHost:
    host = CardHost(tmp_path / "master", "master")
    host.start()
    return host


def give(host: CardHost, version: str) -> Path:
    path = host.boot / f"laserbot-{version}.update"
    write_update(path, version)
    return path


def is_whole(host: CardHost, version: str) -> bool:
    folder = host.store.served.parent / "versions" / version
    files = {name: (folder / name).read_bytes() for name in host.store.manifest(version).files}
    return {name: (len(one), sha256(one).hexdigest()) for name, one in files.items()} == host.store.manifest(
        version
    ).files


def test_a_card_begins_with_its_own_version_of_which_the_robots_get_only_the_name(master: CardHost) -> None:
    assert master.runs == "1"
    assert (master.serves.version, master.serves.files, master.serves.arena) == ("1", {}, "laser-bot-master")
    assert master.store.stored() == set()


def test_an_update_is_taken_at_the_next_start_and_served(master: CardHost) -> None:
    given = manifest_of(give(master, "2"))
    master.start(arena="hall")
    assert master.runs == "2"
    assert list(master.boot.iterdir()) == []
    assert master.serves == given.of("robot")._replace(arena="hall")
    for name in master.serves.files:
        assert (master.store.served / name).is_file()
    assert not (master.store.served / "master").exists()
    assert not master.told


def test_a_card_keeps_one_way_back_and_its_own_version(master: CardHost) -> None:
    for version in "234":
        give(master, version)
        master.start()
    assert master.store.stored() == {"4", "3"}
    assert master.engine.images == {image("master", "4"), image("master", "3")}
    assert master.runs == "4"


def test_a_line_takes_the_card_and_its_robots_back_and_forth(master: CardHost) -> None:
    for version in "23":
        give(master, version)
        master.start()
    for settings, version in (({"version": "previous"}, "2"), ({"version": "previous"}, "2"), ({}, "3")):
        master.start(**settings)
        assert ("laserbot-of-2" in master.engine.containers) is (version == "2")
        assert (master.runs, master.serves.version) == (version, version)
        assert master.serves.files
        assert master.store.stored() == {"2", "3"}


def test_before_the_first_update_the_way_back_leads_nowhere(master: CardHost) -> None:
    master.start(version="previous")
    assert master.runs == "1"


def test_an_update_that_comes_while_the_line_says_back_waits_for_the_line(master: CardHost) -> None:
    for version in "23":
        give(master, version)
        master.start()
    give(master, "4")
    master.start(version="previous")
    assert master.runs == "2"
    assert master.told == ["laserbot-4.update: is taken, and runs once laserbot.txt no longer says version = previous"]
    master.start()
    assert master.runs == "4"
    master.start(version="previous")
    assert master.runs == "2", "not the one that a person has turned away from"


@pytest.mark.parametrize("fault", ["ill", "restless", "unreadable"])
def test_a_version_that_does_not_run_is_left_again_and_told(fault: str, master: CardHost) -> None:
    give(master, "2")
    images: set[str] = getattr(master.engine, fault)
    images.add(image("master", "2"))
    master.start()
    assert master.runs == "1"
    [told] = master.told
    assert told.startswith("version 2 does not run here: ")
    assert told.endswith("; version 1, with which the card was made, is run instead")
    assert (master.store.stored(), master.serves.version) == (set(), "1")
    assert master.engine.images == {image("master", "1")}
    # a person may try it again
    images.clear()
    give(master, "2")
    master.start()
    assert master.runs == "2"


def test_what_was_not_healthy_before_need_not_be_so_with_another_version(master: CardHost) -> None:
    master.engine.ill.add("laserbot-announcer")
    master.start()
    give(master, "2")
    master.start()
    assert master.runs == "2"


def test_what_is_not_healthy_yet_when_the_card_starts_was_so_before(master: CardHost) -> None:
    master.engine.ill |= {image("master", "1"), "laserbot-web"}
    give(master, "2")
    master.start()
    assert master.runs == "1"
    assert master.told == [
        "version 2 does not run here: these do not stay up, or are not healthy: laserbot-web; "
        "version 1, with which the card was made, is run instead"
    ]


def test_what_a_new_version_does_not_have_is_not_waited_for(master: CardHost) -> None:
    for version in "23":
        give(master, version)
        master.start()
    assert "laserbot-of-2" not in master.engine.containers
    assert master.runs == "3"


@pytest.mark.parametrize("memory", [None, "", "[]", "5", '["laserbot-of-2"]'])
@pytest.mark.parametrize("ill, runs", [((), "3"), (("laserbot-announcer",), "1")])
def test_if_it_is_not_known_what_was_healthy_all_has_to_be(
    ill: tuple[str, ...], runs: str, memory: str | None, tmp_path: Path
) -> None:
    host = CardHost(tmp_path, "master")
    if memory is not None:
        host.start()
        (host.store.served.parent / "healthy.json").write_text(memory)
    host.engine.ill |= {*ill}
    give(host, "3")
    host.start()
    assert host.runs == runs


def test_it_is_told_which_version_runs_instead(master: CardHost) -> None:
    for version in "23":
        give(master, version)
        master.engine.restless = {image("master", "3")}
        master.start()
    assert master.told == [
        "version 3 does not run here: these do not stay up, or are not healthy: laserbot-announcer, laserbot-web; "
        "version 2 is run instead"
    ]
    assert master.runs == "2"


def test_why_a_version_did_not_run_is_told_until_another_runs(master: CardHost) -> None:
    give(master, "2")
    master.engine.restless = {image("master", "2")}
    master.start()
    [told] = master.told
    (master.boot / "no.update").write_text("no update")
    master.start()
    assert master.told[0] == told, "whoever sees no change switches it off and on again, and looks then"
    assert len(master.told) == 2
    (master.boot / "no.update").unlink()
    master.start()
    assert master.told == [told]
    give(master, "3")
    master.start()
    assert (master.runs, master.told) == ("3", [])


def stop(host: CardHost, *names: str) -> None:
    """As a person does."""
    for name in names:
        host.engine.containers[name]["State"]["Status"] = "exited"


def test_a_container_that_a_person_has_stopped_says_nothing_of_a_version(master: CardHost) -> None:
    stop(master, "laserbot-announcer")
    give(master, "2")
    master.engine.restless.add("laserbot-announcer")
    master.start()
    assert not master.told
    assert master.store.state() == State("2", "1")


def test_if_a_person_has_stopped_all_they_have_to_stay_up_nevertheless(master: CardHost) -> None:
    stop(master, "laserbot-announcer", "laserbot-web")
    give(master, "3")
    master.engine.restless.add("laserbot-announcer")
    master.start()
    assert master.runs == "1"


def test_what_is_the_same_in_the_new_version_and_stopped_stays_so(master: CardHost) -> None:
    """As all of a robot's containers, when only the master's have changed."""
    stop(master, "laserbot-announcer", "laserbot-web")
    give(master, "1+x")
    master.start()
    assert not master.told
    assert master.store.state() == State("1+x", "1")
    assert {one["State"]["Status"] for one in master.engine.containers.values()} == {"exited"}


def test_the_cards_own_version_is_the_last_resort(master: CardHost) -> None:
    give(master, "2")
    master.start()
    master.engine.images.clear()
    master.engine.containers.clear()
    master.engine.unreadable.add(image("master", "2"))
    master.start()
    assert master.runs == "1"
    assert master.serves.version == "2", "the robots have nothing to do with it"
    master.engine.unreadable.clear()
    master.start()
    assert master.runs == "2"


def test_an_engine_that_fails_is_told_once_until_it_works(master: CardHost) -> None:
    """The unit starts the program again every 10 s."""
    give(master, "2")
    master.start()
    master.engine.containers.clear()
    master.engine.images.clear()
    master.engine.unreadable |= {image("master", "1"), image("master", "2")}
    for _ in range(3):
        master.settle(Card(role="master"))
    assert [line.partition(":")[0] for line in master.told] == [
        "version 2 does not run here",
        "the game cannot be started",
    ]
    master.engine.unreadable.clear()
    master.settle(Card(role="master"))
    assert master.runs == "2"
    assert not master.told


def test_an_engine_that_is_away_is_told_in_one_line(tmp_path: Path) -> None:
    host = CardHost(tmp_path, "master")
    host.engine = Socket(str(tmp_path / "no.sock"))  # type: ignore[assignment]
    host.settle(Card(role="master"))
    assert host.told == ["the game cannot be started: the engine does not answer: No such file or directory"]
    assert not host.restarts


def test_an_engine_that_stays_of_no_use_is_given_up_once(master: CardHost) -> None:
    away, engine = Mock(ask=Mock(side_effect=ConnectionError("the engine does not answer"))), master.engine
    card = Card(role="master")
    for tries in range(2 * TRIES):
        master.engine = away
        master.settle(card, tries)
        assert master.restarts == (tries >= TRIES)
    master.engine = engine
    master.start()
    assert engine.changes.count("POST /images/load?quiet=1") == 2, "it had lost all that it had"
    assert master.runs == "1"
    # well meanwhile: it may be given up again
    master.engine = away
    master.settle(card, TRIES)
    assert master.restarts == 2


def test_an_engine_that_runs_the_game_is_not_given_up(master: CardHost) -> None:
    master.engine.unreadable.add(image("master", "2"))
    master.engine.containers["laserbot-web"]["Config"]["Labels"] = {LABEL: "another laserbot.txt"}
    master.engine.images.clear()
    master.engine.unreadable.add(image("master", "1"))
    master.settle(Card(role="master"), TRIES)
    assert "invalid tar header" in master.told[0]
    assert not master.restarts


def test_a_card_that_is_broken_itself_is_no_fault_of_the_engine(master: CardHost) -> None:
    for path in (master.store.image("1").parent / "containers").iterdir():
        path.write_text("")
    master.settle(Card(role="master"), TRIES)
    assert "is broken" in master.told[0]
    assert not master.restarts


@pytest.mark.parametrize("content", ["", '{"Image": "webserver:x-2", "Env": [1]}'])
def test_a_version_that_is_damaged_on_the_card_is_left(content: str, master: CardHost) -> None:
    give(master, "2")
    master.start()
    (master.store.served.parent / "versions/2/master/containers/web.json").write_text(content)
    master.start()
    assert master.runs == "1"
    assert "web.json describes no container" in master.told[0]


def test_an_archive_that_is_broken_stays_where_it_is_and_changes_nothing(master: CardHost) -> None:
    path = give(master, "2")
    content = path.read_bytes()
    path.write_bytes(content[:5000])
    before = sorted(path for path in master.store.served.parent.rglob("*"))
    master.engine.changes.clear()
    master.start()
    assert master.told == ["laserbot-2.update: ends too early: copy it again"]
    assert path.stat().st_size == 5000
    assert sorted(path for path in master.store.served.parent.rglob("*") if path.name != "versions") == before
    assert not master.engine.changes
    path.write_bytes(content)
    master.start()
    assert master.runs == "2"


def test_an_archive_for_which_there_is_no_room_is_told(master: CardHost, monkeypatch: pytest.MonkeyPatch) -> None:
    path = give(master, "2")
    with monkeypatch.context() as patch:
        patch.setattr("cards.store.ROOM", 1 << 50)
        master.start()
    assert "MiB on the card, which has" in master.told[0]
    assert path.exists()
    assert master.runs == "1"


def test_what_a_cut_has_left_takes_no_room(master: CardHost, monkeypatch: pytest.MonkeyPatch) -> None:
    left = master.store.served.parent / "versions/.new"
    left.mkdir(parents=True)
    give(master, "2")
    usage = shutil.disk_usage
    monkeypatch.setattr("shutil.disk_usage", lambda path: usage(path)._replace(free=0 if left.exists() else 1 << 40))
    master.start()
    assert master.runs == "2"


def test_an_engine_that_hangs_up_is_told(master: CardHost, monkeypatch: pytest.MonkeyPatch) -> None:
    give(master, "2")
    with monkeypatch.context() as patch:
        patch.setattr(master.engine, "ask", Mock(side_effect=EngineError("GET / breaks off")))
        master.start()
    assert master.told == ["laserbot-2.update: GET / breaks off", "the game cannot be started: GET / breaks off"]
    master.start()
    assert master.runs == "2"


def test_without_the_first_partition_the_card_runs(master: CardHost) -> None:
    master.boot.rmdir()
    master.start()
    assert master.runs == "1"


def test_of_several_archives_none_is_taken(master: CardHost) -> None:
    for version in "32":
        give(master, version)
    master.start()
    assert master.told == [f"laserbot-{version}.update: is not the only one: leave one on the card" for version in "23"]
    assert master.runs == "1"


def test_a_macs_shadow_of_an_archive_is_none_and_capital_letters_do_not_matter(master: CardHost) -> None:
    give(master, "2").rename(master.boot / "LASERB~1.UPDATE")
    (master.boot / "._laserbot-2.update").write_bytes(b"\0\5\26\7")
    master.start()
    assert master.runs == "2"
    assert not master.told


def test_a_robots_card_takes_none(tmp_path: Path) -> None:
    robot = CardHost(tmp_path / "robot", "robot")
    give(robot, "2")
    robot.start()
    assert robot.told == ["laserbot-2.update: is for the master's card, from which the robots get it"]
    assert robot.runs == "1"


def test_a_host_to_which_ansible_has_deployed_takes_none(master: CardHost) -> None:
    for container in master.engine.containers.values():
        container["Config"] = {**container["Config"], "Labels": None}
    give(master, "2")
    master.engine.changes.clear()
    master.start()
    assert master.told == ["laserbot-2.update: is not for a host to which Ansible has deployed: take update.yml"]
    assert not master.engine.changes


def test_the_same_archive_again_changes_nothing_and_another_of_that_version_is_refused(master: CardHost) -> None:
    give(master, "2")
    master.start()
    master.engine.changes.clear()
    give(master, "2")
    master.start()
    assert list(master.boot.iterdir()) == []
    assert (master.runs, master.store.state()) == ("2", State("2", "1"))
    assert not master.engine.changes
    path = give(master, "3")
    path.write_bytes(path.read_bytes().replace(b'"version": "3"', b'"version": "2"'))
    master.start()
    assert master.told == ["laserbot-3.update: is another 2 than the one that is here already"]


def test_an_archive_of_the_cards_own_version_brings_it_to_the_robots(master: CardHost) -> None:
    give(master, "1")
    master.engine.changes.clear()
    master.start()
    assert not master.engine.changes
    assert master.serves.files
    assert list(master.boot.iterdir()) == []


@pytest.mark.parametrize(
    "content", [b"", b"{}", b"[]", b"\0\xff", b'{"current": "9", "previous": "9", "trial": "", "refused": []}']
)
def test_a_memory_that_is_lost_leaves_the_cards_own_version(content: bytes, master: CardHost) -> None:
    give(master, "2")
    master.start()
    (master.store.served.parent / "state.json").write_bytes(content)
    master.start()
    assert master.runs == "1"
    give(master, "3")
    master.start()
    assert master.runs == "3"


def test_the_archive_goes_when_all_of_it_would_outlast_the_power(
    master: CardHost, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = give(master, "2")
    state = master.store.served.parent
    new = {f"versions/.new/{name}" for name in manifest_of(path).files} | {"versions/.new/manifest.json.new"}
    needed = {state / name for name in new} | {state / "versions", state / "state.json.new", state}
    synced: set[str] = set()
    unlink = os.unlink

    def remove(removed: Path, **options: Any) -> None:
        assert removed != path or needed <= set(map(Path, synced))
        unlink(removed, **options)

    monkeypatch.setattr("os.fsync", lambda handle: synced.add(os.readlink(f"/proc/self/fd/{handle}")))
    monkeypatch.setattr("os.unlink", remove)
    master.start()
    assert not path.exists()


@pytest.mark.parametrize("ends, fault", [("4", ""), ("3", "restless"), ("3", "ill")])
def test_the_power_may_go_at_any_step(
    ends: str, fault: str, master: CardHost, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At each there is a whole version on the card, and the new one in one of two places; in the end it runs or, if it
    does not run here, the one before does."""
    for version in "23":
        give(master, version)
        master.start()
    if fault:
        getattr(master.engine, fault).add(image("master", "4"))
    give(master, "4")
    for steps in count():
        host = master.copy(tmp_path / str(steps))
        is_cut = False
        try:
            with power(steps, host.engine, monkeypatch):
                host.start()
        except Cut:
            is_cut = True
        state = host.store.state()
        assert state.current in host.store.stored()
        assert list(host.boot.glob("*.update")) or "4" in {*host.store.stored(), *state.refused}
        assert all(is_whole(host, version) for version in host.store.stored())
        host.start()
        assert host.runs == host.serves.version == ends
        assert list(host.boot.glob("*.update")) == []
        assert host.store.state() == (State("4", "3") if ends == "4" else State("3", "2", refused=("4",)))
        kept = {"3", "4" if ends == "4" else "2"}
        assert {path.name for path in (host.store.served.parent / "versions").iterdir()} == kept
        loaded = {image("master", version) for version in kept}
        # after a cut while an image was loaded, it is the only one: the others are loaded when they are needed
        assert host.engine.images in (loaded, {image("master", ends)})
        assert not host.engine.hollow & host.engine.images
        if not is_cut:
            break
    assert steps > 30
