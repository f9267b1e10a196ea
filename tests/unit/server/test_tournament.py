"""A tournament by itself: who meets whom, and who has won, for every number of players."""

from collections import Counter
from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from server.game.draw import LEAST, MOST, Kind, draw, group_members, group_numbers, seeding, usual_groups
from server.game.tournament import CORRECTED, NO_SHOW, Tournament

PLAYERS = range(LEAST, MOST + 1)
DIVIDED = [(players, usual_groups(players)) for players in PLAYERS]
DIVIDED += [(players, groups) for players in (6, 17, 30, 64) for groups in group_numbers(players)]


def new(players: int, groups: int = 0, **options) -> Tournament:
    kind = Kind.GROUPS if groups else Kind.KNOCK_OUT
    names = tuple(f"p{seed}" for seed in range(1, players + 1))
    return Tournament("Cup", kind, names, groups=groups, **options)


def play(tournament: Tournament, choose=min) -> Tournament:
    """All matches, one after another; `choose` says which of two seeds wins."""
    while match := tournament.next_match():
        one, other = tournament.result(match).players
        tournament = tournament.with_game(match.number, choose((one, other)), 0.0)
    return tournament


def played(tournament: Tournament) -> list[tuple[int, int]]:
    return [tournament.result(match).players for match in tournament.matches]


@pytest.mark.parametrize("players", PLAYERS)
def test_in_a_knock_out_everybody_but_the_winner_loses_once(players):
    tournament = play(new(players))
    lost = Counter(tournament.result(match).loser for match in tournament.matches)
    assert len(tournament.matches) == players - 1
    assert set(lost) == set(range(2, players + 1))
    assert set(lost.values()) == {1}
    assert tournament.champion == 1


@pytest.mark.parametrize("players", PLAYERS)
def test_byes_are_those_of_the_best_and_nobody_has_two(players):
    matches = draw(Kind.KNOCK_OUT, players)
    size = max(match.round for match in matches)
    assert size >= players > size // 2
    first = {side.number for match in matches if match.round == size for side in match.sides}
    assert set(range(1, players + 1)) - first == set(range(1, size - players + 1))
    second = [side.number for match in matches if match.round < size for side in match.sides if side.what == "seed"]
    assert sorted(second) == list(range(1, size - players + 1))


def test_the_best_two_meet_in_the_final_and_the_best_four_in_the_semifinals():
    assert seeding(8) == [1, 8, 4, 5, 2, 7, 3, 6]
    for players in PLAYERS:
        tournament = play(new(players))
        of_four = [match for match in tournament.matches if match.round == 4]
        assert {frozenset(tournament.result(match).players) for match in of_four} == {
            frozenset({1, 4}),
            frozenset({2, 3}),
        }
        assert set(played(tournament)[-1]) == {1, 2}


@pytest.mark.parametrize("players", PLAYERS)
def test_the_third_place_is_played_for_by_those_who_lose_the_semifinals_before_the_final(players):
    tournament = play(new(players, third=True))
    *_, third, final = tournament.matches
    assert third.third
    assert final.round == 2
    assert set(tournament.result(third).players) == {3, 4}


@pytest.mark.parametrize(("players", "groups"), DIVIDED)
def test_in_a_group_each_meets_each_once_and_the_first_two_go_on(players, groups):
    tournament = play(new(players, groups))
    members = group_members(players, groups)
    assert sorted(seed for group in members for seed in group) == list(range(1, players + 1))
    assert max(map(len, members)) - min(map(len, members)) <= 1
    for number, seeds in enumerate(members, 1):
        pairs = [
            tuple(sorted(tournament.result(match).players)) for match in tournament.matches if match.group == number
        ]
        assert sorted(pairs) == sorted(combinations(seeds, 2))
    knock_out = [match for match in tournament.matches if not match.group]
    assert len(knock_out) == 2 * groups - 1
    through = {seed for match in knock_out for seed in tournament.result(match).players}
    assert through == {seed for seeds in members for seed in sorted(seeds)[:2]}
    assert tournament.champion == 1


@pytest.mark.parametrize(("players", "groups"), DIVIDED)
def test_nobody_plays_twice_in_a_round_of_a_group(players, groups):
    matches = [match for match in draw(Kind.GROUPS, players, groups) if match.group]
    for number in {match.round for match in matches}:
        seeds = [side.number for match in matches if match.round == number for side in match.sides]
        assert len(set(seeds)) == len(seeds)


@pytest.mark.parametrize("groups", range(2, 22))
def test_after_the_groups_nobody_meets_one_of_the_own_group_at_once(groups):
    first = [match for match in draw(Kind.GROUPS, 3 * groups, groups) if not match.group]
    for match in first:
        one, other = match.sides
        if one.what == other.what == "group":
            assert one.number != other.number


def test_groups_are_of_four_or_a_few_more():
    assert [usual_groups(players) for players in (4, 5, 7, 8, 9, 12, 16, 64)] == [1, 1, 1, 2, 2, 3, 4, 16]
    for players in PLAYERS:
        assert usual_groups(players) in group_numbers(players)


@given(st.data())
def test_whatever_happens_each_match_is_between_two_and_there_is_one_winner(data):
    players = data.draw(st.sampled_from([4, 5, 7, 11, 16]))
    groups = data.draw(st.sampled_from([0, *group_numbers(players)]))
    tournament = new(players, groups, best_of=data.draw(st.sampled_from([1, 3, 5])), third=data.draw(st.booleans()))
    for _ in range(data.draw(st.integers(0, 30))):
        known = [match for match in tournament.matches if all(tournament.result(match).players)]
        match = data.draw(st.sampled_from(known))
        result = tournament.result(match)
        winner = data.draw(st.sampled_from(result.players))
        if result.winner:
            tournament = tournament.with_winner(match.number, winner, CORRECTED)
        elif data.draw(st.booleans()):
            tournament = tournament.with_winner(match.number, winner, NO_SHOW)
        else:
            tournament = tournament.with_game(match.number, winner, 0.0)
    tournament = play(tournament, choose=lambda pair: data.draw(st.sampled_from(pair)))
    results = [tournament.result(match) for match in tournament.matches]
    assert all(result.winner in result.players for result in results)
    assert all(max(result.wins) == tournament.best_of // 2 + 1 for result in results)
    assert all(len(set(result.players)) == 2 for result in results)
    lost = Counter(
        result.loser
        for result, match in zip(results, tournament.matches, strict=True)
        if not match.group and not match.third
    )
    assert set(lost.values()) == {1}
    assert tournament.champion not in lost


def test_best_of_three_is_over_when_one_has_two():
    tournament = new(4, best_of=3).with_game(1, 1, 0.0)
    assert not tournament.result(tournament.matches[0]).winner
    assert tournament.with_game(1, 1, 0.0).result(tournament.matches[0]).winner == 1
    both = tournament.with_game(1, 4, 0.0)
    assert (both.result(both.matches[0]).wins, both.result(both.matches[0]).winner) == ((1, 1), 0)


def test_a_correction_opens_again_what_others_play_by_it_and_nothing_else():
    tournament = play(new(8))
    corrected = tournament.with_winner(1, 8, CORRECTED)
    winners = [corrected.result(match).winner for match in corrected.matches]
    assert winners == [8, 4, 2, 3, 0, 2, 0]
    assert [match.number for match in corrected.pending()] == [5, 7]
    assert play(corrected).champion == 2


def test_a_table_counts_matches_then_games_then_seeds():
    tournament = new(4, 1, best_of=3)
    for match in tournament.matches[:6]:
        one, other = tournament.result(match).players
        better = min(one, other) if {one, other} != {1, 3} else 3
        games = [better, better] if {one, other} != {3, 4} else [4, 3, 3]
        if {one, other} == {2, 3}:
            games = [2, 2]
        for seed in games:
            tournament = tournament.with_game(match.number, seed, 0.0)
    rows = [(row.seed, row.played, row.won, row.games_won, row.games_lost) for row in tournament.table(1)]
    assert rows == [(1, 3, 2, 4, 2), (2, 3, 2, 4, 2), (3, 3, 2, 4, 3), (4, 3, 0, 1, 6)]
