"""How often each viewer of the arena gets a state."""

import asyncio
from itertools import pairwise

from laser_bot_battle.openings import OF_ADDRESS
from sim.arena.viewers import CROWD, CROWD_RATE, MAX_VIEWERS, RATE, Clock, Viewer, Viewers


def crowd(count: int) -> tuple[Viewers, list[Viewer]]:
    viewers, each = Viewers(), [Viewer() for _ in range(count)]
    for viewer in each:
        viewers.add(viewer)
    return viewers, each


def test_few_viewers_all_get_every_state() -> None:
    viewers, each = crowd(CROWD)
    for viewer in each[:10]:
        viewers.hear(viewer, "watch")
    assert not any(viewer.thinned for viewer in each)


def test_in_a_crowd_the_first_who_need_every_state_get_it() -> None:
    _, each = crowd(CROWD + 6)
    assert [viewer.thinned for viewer in each] == [False] * CROWD + [True] * 6


def test_in_a_crowd_who_only_watches_gives_way_to_who_drives() -> None:
    viewers, each = crowd(200)
    for viewer in each[:150]:
        viewers.hear(viewer, "watch")
    assert [viewer.thinned for viewer in each] == [True] * 150 + [False] * 50
    viewers.hear(each[0], "drive")
    assert not each[0].thinned


def test_when_the_crowd_leaves_all_get_every_state_again() -> None:
    viewers, each = crowd(CROWD + 1)
    assert each[-1].thinned
    viewers.remove(each[0])
    assert not any(viewer.thinned for viewer in each)


def test_other_words_change_nothing() -> None:
    viewers, each = crowd(CROWD + 1)
    for text in ("", "WATCH", "watch ", '{"op":"watch"}', "x" * 1000):
        viewers.hear(each[0], text)
    assert not each[0].watches


def test_there_is_a_most() -> None:
    viewers, each = crowd(MAX_VIEWERS - 1)
    assert not viewers.refusal("10.0.0.1")
    viewers.add(Viewer())
    assert viewers.refusal("10.0.0.1") == "512 look on already"
    viewers.remove(each[0])
    assert not viewers.refusal("10.0.0.1")


def test_one_address_has_a_share() -> None:
    viewers, each = Viewers(), [Viewer("10.0.0.1") for _ in range(OF_ADDRESS)]
    for viewer in each:
        assert not viewers.refusal("10.0.0.1")
        viewers.add(viewer)
    assert viewers.refusal("10.0.0.1") == "50 viewers have your address already"
    assert not viewers.refusal("10.0.0.2")
    viewers.remove(each[0])
    assert not viewers.refusal("10.0.0.1")


def test_the_thinned_get_their_states_evenly() -> None:
    async def ticks_heard(thinned: bool) -> list[int]:
        clock, heard = Clock(), []

        async def listen() -> None:
            while True:
                await clock.wait(Viewer(thinned=thinned))
                heard.append(number)

        listener = asyncio.create_task(listen())
        for number in range(RATE * 2):  # noqa: B007 - listen() reads it
            await asyncio.sleep(0)
            clock.tick()
            await asyncio.sleep(0)
        listener.cancel()
        return heard

    assert asyncio.run(ticks_heard(False)) == list(range(RATE * 2))
    some = asyncio.run(ticks_heard(True))
    assert len(some) == CROWD_RATE * 2
    assert {later - sooner for sooner, later in pairwise(some)} == {2, 3}
