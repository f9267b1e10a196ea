"""The pages' colours: tokens, which are for day and night; any other one says why it is there."""

import re

import pytest

from tests.support.programs import ROOT

CSS = ROOT / "server" / "static" / "css"
COLOUR = re.compile(r"#[0-9a-fA-F]{3,8}\b|\b(?:rgb|hsl)a?\(")
TOKEN = re.compile(r"--([\w-]+): light-dark\((#\w+), (#\w+)\)")
ROBOTS = 8  # colours


@pytest.mark.parametrize("path", sorted(CSS.glob("*.css")), ids=lambda path: path.name)
def test_colours_are_tokens(path) -> None:
    if path.name == "common.css":
        return  # where they are declared
    lines = enumerate(path.read_text().splitlines(), 1)
    bare = [f"{number}: {line.strip()}" for number, line in lines if is_bare(line)]
    assert bare == [], "use a token of common.css, or say in a comment on the line why not"


def is_bare(line: str) -> bool:
    return "/*" not in line and ".night" not in line and COLOUR.search(line) is not None


def luminance(colour: str) -> float:
    digits = colour[1:] if len(colour) == 7 else "".join(2 * digit for digit in colour[1:])
    parts = [int(digits[place : place + 2], 16) / 255 for place in (0, 2, 4)]
    red, green, blue = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    """As WCAG 2 defines it, 1 to 21."""
    dark, bright = sorted((luminance(one), luminance(other)))
    return (bright + 0.05) / (dark + 0.05)


def tokens() -> dict[str, tuple[str, str]]:
    """By name, for day and night."""
    return {name: (day, night) for name, day, night in TOKEN.findall((CSS / "common.css").read_text())}


TEXTS = [
    "text",
    "muted",
    "accent",
    "laser",
    "green",
    "amber",
    "red",
    "gold",
    *(f"team-{team}" for team in (1, 2, 3, 4)),
]


@pytest.mark.parametrize("text", TEXTS)
@pytest.mark.parametrize("ground", ["night", "sky", "panel", "field"])
def test_text_can_be_read_on_every_ground(text: str, ground: str) -> None:
    for colour, back in zip(tokens()[text], tokens()[ground], strict=True):
        assert contrast(colour, back) >= 4.5


@pytest.mark.parametrize("robot", range(ROBOTS))
def test_a_robots_lines_stand_out_and_a_name_in_its_colour_can_be_read(robot: int) -> None:
    for back in ("panel", "field"):
        for colour, ground in zip(tokens()[f"robot-{robot}"], tokens()[back], strict=True):
            assert contrast(colour, ground) >= 4.5


def test_a_robot_has_the_arenas_colour_on_every_page() -> None:
    arena = re.findall(r"#[0-9a-f]{6}", (ROOT / "server/static/js/arena/colours.js").read_text().split("]")[0])
    assert arena == [tokens()[f"robot-{robot}"][1] for robot in range(ROBOTS)]
    assert f"const COLOURS = {ROBOTS};" in (CSS.parent / "js/common/robot_colours.js").read_text()
