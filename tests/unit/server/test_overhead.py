"""What the desk tells of the camera above the floor."""

from laser_bot_battle.msg import OverheadStatus
from server.ros.overhead import FORGOTTEN, LONGEST, MOST, SILENT, OverheadTroubles


def test_its_troubles_hold_until_it_has_none_or_falls_silent() -> None:
    time = 100.0
    overhead = OverheadTroubles(clock=lambda: time)
    assert overhead.now() == [], "a hall without such a camera misses none"
    overhead.hear(OverheadStatus(troubles=["tag 3 is bent", "tag 4 is dark"]))
    time += SILENT
    assert overhead.now() == ["tag 3 is bent", "tag 4 is dark"]
    overhead.hear(OverheadStatus())
    assert overhead.now() == []
    time += SILENT + 1
    (gone,) = overhead.now()
    assert "does not run any more" in gone
    time += FORGOTTEN
    assert overhead.now() == []


def test_whoever_publishes_there_cannot_flood_the_desk() -> None:
    overhead = OverheadTroubles(clock=lambda: 0.0)
    overhead.hear(OverheadStatus(troubles=["x" * 10_000] * 1000))
    assert overhead.now() == ["x" * LONGEST] * MOST
