"""Sets of rules: those that there are everywhere, and the operators' own."""

from functools import partial
from typing import Any

import pytest

from server.game import desk
from server.game.presets import BUILT_IN
from server.game.referee import Referee
from server.game.rules import DECLARED, Rules, checked

# what the robots, their light and the hall's network can do: presets leave it alone
OF_THE_HALL = {"light", "light_damage", "line_of_fire", "fence", "seats", "player_timeout", "seat_timeout"}


def presets(match) -> dict[str, dict[str, Any]]:
    """The operators' own."""
    return {one["name"]: one["rules"] for one in match.referee.overview(match.now)["presets"] if one["own"]}


def operate(match, wish: Any, **wanted: Any) -> None:
    match.referee.operate(partial(wish, by="Ann", **wanted), match.now)


@pytest.mark.parametrize("preset", BUILT_IN, ids=lambda preset: preset.name)
def test_what_a_preset_wants_is_possible_and_leaves_nothing_of_another(preset):
    for rule, value in preset.rules.items():
        assert value is None or checked(rule, value) == value
    assert DECLARED.keys() - preset.rules.keys() == OF_THE_HALL
    assert any(value is not None for value in preset.rules.values())


def test_a_kept_preset_names_every_rule_and_replaces_one_of_its_name(match):
    operate(match, desk.change_rules, changes={"hit_damage": 25})
    operate(match, desk.save_preset, name=" ours ")
    assert presets(match) == {"ours": {rule: 25 if rule == "hit_damage" else None for rule in DECLARED}}
    operate(match, desk.change_rules, changes={"hit_damage": None, "idle": 30})
    operate(match, desk.save_preset, name="ours")
    assert [(rules["hit_damage"], rules["idle"]) for rules in presets(match).values()] == [(None, 30)]


def test_presets_outlive_the_program_and_come_to_light_late(match):
    operate(match, desk.save_preset, name="ours")
    kept, saved = presets(match), match.referee.saved(match.now)
    match.restart()
    assert presets(match) == kept
    match.referee = Referee(Rules())
    operate(match, desk.save_preset, name="newer")
    for _ in range(2):
        match.referee.take_over(saved, {}, match.now)
    assert list(presets(match)) == ["newer", "ours"]


def test_a_rule_that_only_another_version_knows_is_left_out(match):
    operate(match, desk.save_preset, name="ours")
    saved = match.referee.saved(match.now)
    saved["presets"][0]["rules"]["of_tomorrow"] = 1
    match.restart(saved=saved)
    assert presets(match)["ours"].keys() == DECLARED.keys()


def test_only_so_many_are_kept_until_one_is_removed(match):
    for number in range(desk.MAX_PRESETS):
        operate(match, desk.save_preset, name=f"preset {number}")
    with pytest.raises(desk.RefusedError, match="remove one"):
        operate(match, desk.save_preset, name="one more")
    operate(match, desk.change_rules, changes={"hit_damage": 25})
    operate(match, desk.save_preset, name="preset 3")
    operate(match, desk.remove_preset, name="preset 0")
    operate(match, desk.save_preset, name="one more")
    assert len(presets(match)) == desk.MAX_PRESETS
    with pytest.raises(desk.UnknownError):
        operate(match, desk.remove_preset, name="preset 0")
