"""How many silent connections there may be, and for how long."""

from laser_bot_battle.openings import Openings


class Silent:
    def __init__(self, address: str = "10.0.0.1") -> None:
        self.address = address
        self.is_cut = False

    def cut(self) -> None:
        self.is_cut = True


def test_one_address_has_a_share_unless_it_stands_for_many() -> None:
    openings, first = Openings(most=9, of_address=2), Silent()
    assert [openings.add(each, 0.0) for each in (first, Silent(), Silent())] == [True, True, False]
    assert openings.add(Silent("10.0.0.2"), 0.0)
    assert openings.add(Silent(), 0.0, is_many=True)
    assert not openings.add(Silent(), 0.0)
    assert not first.is_cut


def test_of_too_many_the_slowest_gives_way() -> None:
    openings = Openings(most=3, of_address=9)
    each = [Silent(f"10.0.0.{number}") for number in range(5)]
    for opening in each:
        assert openings.add(opening, 0.0)
    assert [opening.is_cut for opening in each] == [True, True, False, False, False]
    assert list(openings) == each[2:]


def test_who_has_said_what_it_wants_is_none_of_them() -> None:
    openings, quick, slow = Openings(), Silent(), Silent()
    openings.add(quick, 10.0)
    openings.add(slow, 11.0)
    openings.remove(quick)
    openings.remove(quick)
    openings.cut_older(11.0)
    assert not slow.is_cut
    openings.cut_older(11.1)
    assert (slow.is_cut, quick.is_cut) == (True, False)
