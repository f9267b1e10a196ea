"""The track of a battle: what is kept of the positions that are seen, and how its pieces become one."""

import json
import math

from server.store.track import MAX_POINTS, PIECE, RATE, Covered, Floor, Piece, Track, join

FLOOR = Floor(2.0, 1.0, ((0, 0, 2, 0),))


def pieces_of(track: Track, seconds: float, hz: float = 25, began: float = 1000.0, robots: int = 2) -> list[Piece]:
    """Robots are seen so often for so long; they drive along x with 1 mm/s."""
    pieces = []
    for tick in range(round(seconds * hz)):
        at = tick / hz
        piece = track.see(began + at, FLOOR, {robot: (at / 1000, robot, -math.pi / 2) for robot in range(robots)})
        pieces += [piece] if piece else []
    last = track.take()
    return [*pieces, last] if last else pieces


def test_positions_are_kept_five_times_a_second_in_pieces_of_ten_seconds():
    pieces = pieces_of(Track(7, [0, 1], 300), 25)
    assert [piece.battle for piece in pieces] == [7, 7, 7]
    assert [round(piece.times[0]) for piece in pieces] == [1000, 1010, 1020]
    whole = join(piece.to_json(1000.0) for piece in pieces)
    assert whole
    assert abs(len(whole["times"]) - 25 * RATE) <= 1
    assert whole["floor"] == {"width": 2.0, "height": 1.0, "walls": [[0, 0, 2, 0]]}
    assert whole["robots"].keys() == {"0", "1"}
    assert whole["robots"]["1"][100] == (0.02, 1, 270)
    assert all(len(seen) == len(whole["times"]) for seen in whole["robots"].values())


def test_one_that_comes_a_little_late_costs_no_other_one():
    track = Track(1, [0], 300)
    for number in range(45):
        track.see(number / RATE + 0.02 * (number % 3), FLOOR, {0: (0, 0, 0)})
    piece = track.take()
    assert piece
    assert len(piece.times) >= 43


def test_only_who_fights_is_kept_and_who_is_not_seen_is_nowhere():
    track = Track(1, [3, 5], 300)
    track.see(0.0, FLOOR, {3: (1, 1, 0), 4: (1, 1, 0)})
    track.see(1.0, FLOOR, {5: (1, 1, 0), 3: (math.nan, 1, 0)})
    piece = track.take()
    assert piece
    assert piece.robots == {3: [(1, 1, 0), None], 5: [None, (1, 1, 0)]}


def test_robots_are_covered_only_as_long_as_somebody_may_say_so():
    covered = Covered()
    assert not covered.at(0.0)
    covered.hear([3, 5], 10.0)
    assert covered.at(11.4) == {3, 5}
    assert not covered.at(11.6)
    covered.hear([], 12.0)
    assert not covered.at(12.1)


def test_where_a_covered_robot_was_thought_to_be_is_marked():
    track = Track(1, [3, 5], 300)
    track.see(0.0, FLOOR, {3: (1, 1, 0), 5: (math.nan, 1, 0)}, covered=[3, 5])
    track.see(1.0, FLOOR, {3: (2, 1, 0)})
    piece = track.take()
    assert piece
    whole = join([piece.to_json(0.0)])
    assert whole
    assert whole["robots"] == {"3": [(1, 1, 0, True), (2, 1, 0)], "5": [None, None]}


def test_who_joins_the_battle_later_is_kept_from_then_on():
    track = Track(1, [3], 300)
    track.see(0.0, FLOOR, {3: (1, 1, 0), 5: (1, 1, 0)})
    track.add([3, 5])
    pieces = [track.see(1.0, FLOOR, {3: (1, 1, 0), 5: (2, 1, 0)}), track.take()]
    assert [piece and piece.robots for piece in pieces] == [{3: [(1, 1, 0)]}, {3: [(1, 1, 0)], 5: [(2, 1, 0)]}]
    whole = join(piece.to_json(0.0) for piece in pieces if piece)
    assert whole
    assert whole["robots"]["5"] == [None, (2, 1, 0)]


def test_a_floor_that_cannot_be_is_not_seen():
    track = Track(1, [0], 300)
    for floor in (Floor(0, 1, ()), Floor(math.nan, 1, ()), Floor(1, 1, ((0, 0, math.inf, 1),))):
        track.see(0.0, floor, {0: (0, 0, 0)})
    assert track.take() is None


def test_a_track_is_small_whatever_the_battle():
    for robots, limit, lasts in ((8, 300, 300), (8, 3600, 3600), (128, 300, 300), (8, 300, 1500)):
        pieces = pieces_of(Track(1, range(robots), limit), lasts, hz=6, robots=robots)
        points = sum(len(piece.times) for piece in pieces) * robots
        assert points <= 2 * MAX_POINTS
        assert points >= MAX_POINTS / 2, "and not smaller than it must be"
        if lasts == 300:
            assert points <= MAX_POINTS * 1.02
            assert len(json.dumps(join(piece.to_json(1000.0) for piece in pieces))) < 320_000


def test_a_long_time_limit_does_not_make_a_short_battle_coarse():
    pieces = pieces_of(Track(1, [0, 1], 86_400), 60)
    assert sum(len(piece.times) for piece in pieces) >= 60 * RATE - 2


def test_pieces_of_two_programs_and_one_that_is_there_twice_are_one_track():
    floor = {"width": 2, "height": 1, "walls": []}
    first = {"floor": floor, "times": [0.0, 0.2], "robots": {"0": [[0, 0, 0], [1, 0, 0]], "1": [[0, 1, 0], None]}}
    second = {"floor": floor, "times": [8.0], "robots": {"0": [[2, 0, 0]]}}
    assert join([first, first, second]) == {
        "floor": floor,
        "times": [0.0, 0.2, 8.0],
        "robots": {"0": [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "1": [[0, 1, 0], None, None]},
    }
    assert join([]) is None
    assert PIECE == 10
