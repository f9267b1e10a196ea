"""Names, life and ranking of single users."""

import pytest

from server.game.ranking import ranks
from server.game.users import User, Users, is_valid_name


@pytest.mark.parametrize(
    "name", ["a", "Z", "_", "0", "a_B_9", "x" * 16, "Jörg", "Αλφα", "日本", "हिन्दी", "é", "Ann Lee", "a b c"]
)
def test_good_names(name):
    assert is_valid_name(name)


@pytest.mark.parametrize(
    "name",
    [
        "",
        " ",
        "x" * 17,
        "a  b",
        " a",
        "a ",
        "a\u00a0b",
        "a \u0301b",
        "x" * 8 + " " + "x" * 8,
        "a\n",
        "a-b",
        "[",
        "\\",
        "^",
        "`",
        "e\u0301",
        "\u0301a",
        "a\x00",
        "<b>",
        "a\u200db",
        "\u202ea",
        "😀",
        "a\u3164",
        "operator\ufe0f",
        "²".join("xy") + "-",
    ],
)
def test_bad_names(name):
    assert not is_valid_name(name)


def user(name, **attributes):
    return User(name, 0, "s", 0, 0.0, **attributes)


def test_a_name_is_unique():
    users = Users()
    users.add_user(user("ada"))
    with pytest.raises(ValueError, match="ada"):
        users.add_user(user("ada"))


def test_ranking_is_alive_by_life_then_dead_then_quitters_then_the_others():
    ranked = [
        user("fit", ready=True, life=90),
        user("weak", ready=True, life=10),
        user("died_late", ready=True, life=0, died_at=9.0),
        user("died_early", ready=True, life=0, died_at=5.0),
        user("left_late", ready=True, life=100, left_at=8.0),
        user("left_early", ready=True, life=100, left_at=2.0),
        user("watches", life=100),
    ]
    assert [each.name for _, each in ranks(reversed(ranked))] == [each.name for each in ranked]


def test_only_the_ready_are_counted_ready_and_only_the_living_of_them_alive():
    users = Users()
    for each in (user("a", ready=True), user("b", ready=True, life=0), user("c")):
        users.add_user(each)
    assert [each.name for each in users.get_users_ready()] == ["a", "b"]
    assert [each.name for each in users.get_users_alive()] == ["a"]
