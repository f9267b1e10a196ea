"""A node's watch over the ROS master: slow is not dead, forgotten is."""

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from laser_bot_battle.master import Master, MasterError, MasterWatch
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.ros import RosMaster

Watch = Callable[..., list[str]]


@pytest.fixture
def master(tmp_path: Path) -> Iterator[RosMaster]:
    running = RosMaster(tmp_path)
    running.start()
    yield running
    running.stop()


@pytest.fixture
def watch(master: RosMaster) -> Iterator[Watch]:
    """Start a watch for a node; the list of what it tells."""
    watches: list[MasterWatch] = []

    def start(node: str, gone_after: float = 10.0) -> list[str]:
        told: list[str] = []
        caller = Master(master.uri, node, timeout=0.2)
        watches.append(MasterWatch(caller, told.append, period=0.05, gone_after=gone_after))
        watches[-1].start()
        return told

    yield start
    for one in watches:
        one.stop()


def test_a_master_that_hangs_is_waited_for(master: RosMaster, watch: Watch, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    told = watch("a", gone_after=0.5)
    master.pause()
    try:
        until(lambda: "does not answer" in caplog.text, 5)
        assert not threading.Event().wait(1.5), "three times what an absent master is given"
        assert told == []
    finally:
        master.resume()
    until(lambda: "answers again" in caplog.text, 5)
    assert caplog.text.count("does not answer") == 1, "told once"
    assert told == []


def test_a_restarted_master_does_not_know_the_node_any_more(master: RosMaster, watch: Watch) -> None:
    told = watch("a")
    master.stop()
    master.start()
    until(lambda: told, 5)
    assert "was restarted" in told[0]


def test_a_master_that_nobody_starts_again_is_gone(master: RosMaster, watch: Watch) -> None:
    told = watch("a", gone_after=0.5)
    master.stop()
    until(lambda: told, 5)
    assert "is gone" in told[0]


def test_another_node_of_the_same_name_replaces_the_first(watch: Watch) -> None:
    first, other = watch("a"), watch("b")
    second = watch("a")
    until(lambda: first, 5)
    assert first == ["another node has taken the name /a"]
    assert (second, other) == ([], [])


def test_what_is_no_ros_master_gives_one_kind_of_error(master: RosMaster) -> None:
    with pytest.raises(OSError, match="refused"):
        Master(f"http://127.0.0.1:{free_port()}", "a").call("getPid")
    with pytest.raises(MasterError, match="not set"):
        Master(master.uri, "a").call("getParam", "/nothing")


def test_waiting_for_a_master_ends_when_it_is_there_or_when_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    late = RosMaster(tmp_path / "late")
    stop = threading.Event()
    answers: list[bool] = []
    waiting = threading.Thread(target=lambda: answers.append(Master(late.uri, "a").wait(stop)))
    waiting.start()
    until(lambda: "waiting; start roscore" in caplog.text, 5)
    late.start()
    waiting.join(5)
    late.stop()
    stop.set()
    answers.append(Master(late.uri, "a").wait(stop))
    assert answers == [True, False]
