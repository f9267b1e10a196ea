import pytest

from robot.serial.name_rules import refusal


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("command", ""),
        ("/Robot0/command", ""),
        ("/Robot0", ""),
        ("/chatter", ""),
        ("Robot0/extra", ""),
        ("/Robots/all", ""),
        ("~mine", ""),
        ("/Robot1/command", "another robot's"),
        ("Robot1/command", "another robot's"),
        ("/Robot01/command", "another robot's"),
        ("/Robot1", "another robot's"),
        ("", "not a legal name"),
        ("/", "not a legal name"),
        ("a b", "not a legal name"),
    ],
)
def test_a_device_may_use_its_own_names_and_those_of_no_other_robot(name: str, words: str) -> None:
    reason = refusal(name, "/Robot0", (), speaks=False)
    assert words in reason
    assert bool(reason) == bool(words)


def test_what_the_command_line_maps_is_the_operators_choice() -> None:
    assert refusal("/Robot1/command", "/Robot0", {"/Robot1/command"}, speaks=True) == ""


@pytest.mark.parametrize("name", ["/shots", "shots", "/add_new_robot", "/game_status", "/positions"])
def test_a_device_may_listen_to_the_master_but_not_speak_for_it(name: str) -> None:
    assert "is the master's" in refusal(name, "/Robot0", (), speaks=True)
    assert refusal(name, "/Robot0", (), speaks=False) == ""
