"""The sheets to print: their sizes on paper, and that a printed tag is one."""

import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

from laser_bot_battle.apriltag import Detection, Detector
from laser_bot_battle.floor import read_floor
from laser_bot_battle.tags import TagPose, floor_tags
from server.overhead.print_tags import main
from server.overhead.sheets import floor_sheet, plan_sheet, robot_sheet

PX = 4  # a mm


def sheet_of(text: str) -> ET.Element:
    """It is A4, and its units are mm."""
    root = ET.fromstring(text)
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("210mm", "297mm", "0 0 210 297")
    return root


def path_of(sheet: ET.Element, name: str) -> str:
    (found,) = (each.get("d", "") for each in sheet.iter() if each.get("id") == name)
    return found


def printed(sheet: ET.Element) -> Detection:
    """The tag on it, found in a picture of the sheet."""
    paper = Image.new("L", (210 * PX, 297 * PX), 255)
    draw = ImageDraw.Draw(paper)
    for x, y, width, height in re.findall(r"M([\d.]+) ([\d.]+)h([\d.]+)v([\d.]+)h-[\d.]+z", path_of(sheet, "tag")):
        left, top = float(x) * PX, float(y) * PX
        draw.rectangle((left, top, left + float(width) * PX - 1, top + float(height) * PX - 1), fill=0)
    (found,) = Detector(1).detect(paper.tobytes(), *paper.size)
    return found


@pytest.mark.parametrize(
    ("text", "number"), [(robot_sheet(3), 3), (floor_sheet(207, TagPose(-0.15, 2.4, math.pi / 2)), 207)]
)
def test_a_printed_tag_is_found_and_its_black_square_is_10_cm_wide(text: str, number: int) -> None:
    found = printed(sheet_of(text))
    assert found.number == number
    edges = [math.dist(one, other) / PX for one, other in zip(found.corners, found.corners[1:], strict=False)]
    assert edges == pytest.approx([100, 100, 100], abs=0.3)


def test_a_robots_sheet_has_an_arrow_at_the_tags_upper_edge_inside_the_line_to_cut() -> None:
    sheet = sheet_of(robot_sheet(3))
    lower_left, _, upper_right, upper_left = np.array(printed(sheet).corners) / PX
    x, y = map(float, re.findall(r"M([\d.]+) ([\d.]+)", path_of(sheet, "front"))[0])
    (cut,) = (each for each in sheet.iter() if each.get("class") == "cut")
    assert upper_left[0] < x < upper_right[0]
    assert float(cut.get("y", "")) < y < upper_left[1] < lower_left[1]
    # the white border, 12.5 mm, stays whole
    assert float(cut.get("x", "")) == pytest.approx(upper_left[0] - 12.5, abs=0.3)
    assert y < upper_left[1] - 12.5
    assert "robot 3" in robot_sheet(3)


def test_every_sheet_has_a_line_of_100_mm() -> None:
    floor = read_floor("battle")
    tags = floor_tags(floor)
    for text in (robot_sheet(0), floor_sheet(200, tags[200]), plan_sheet(floor, tags)):
        assert path_of(sheet_of(text), "scale").endswith("h100")
        assert "This line is 100 mm long" in text


def test_the_plan_says_where_each_tag_lies() -> None:
    floor = read_floor("battle")
    tags = floor_tags(floor)
    texts = [each.text for each in sheet_of(plan_sheet(floor, tags)).iter() if each.text]
    assert "202: x = 1.750 m, y = -0.150 m" in texts
    assert {str(number) for number in tags} <= set(texts)


def test_the_program_writes_a_sheet_for_each_tag(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main("tags", ["--out", str(tmp_path / "new"), "--floor", "duel", "--robots", "1-2"]) == 0
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == [
        *(f"floor-{number}.svg" for number in range(200, 206)), "plan.svg", "robot-1.svg", "robot-2.svg",
    ]  # fmt: skip
    assert "9 sheets" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "mistake"),
    [
        (["--robots", "0"], "must be a number of robots, or IDs such as 1-8, up to 127"),
        (["--robots", "100-128"], "up to 127"),
        (["--floor", "hall"], "there is no such floor"),
    ],
)
def test_an_impossible_argument_is_named(arguments: list[str], mistake: str, tmp_path: Path, capsys) -> None:
    with pytest.raises(SystemExit, match="2"):
        main("tags", ["--out", str(tmp_path), *arguments])
    assert mistake in capsys.readouterr().err
