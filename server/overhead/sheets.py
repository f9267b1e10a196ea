"""The sheets with tags to print: A4, in mm, as SVG. Pure."""

from collections.abc import Iterable, Mapping
from html import escape

from laser_bot_battle.apriltag import CELLS
from laser_bot_battle.floor import Floor
from laser_bot_battle.tags import FLOOR_TAG_SIZE, ROBOT_TAG_SIZE, TagPose, tag_picture

WIDTH, HEIGHT = 210, 297  # mm
MIDDLE, TAG_MIDDLE = WIDTH / 2, 120.0  # of the tag
STRIP = 18.0  # above a tag, with what it is
SCALE = 100  # mm, to check the printer by
PLAN = (20.0, 45.0, 170.0, 130.0)  # x, y, width and height of the room for the plan
LINE = 6.0  # from one line of text to the next


def robot_sheet(robot: int) -> str:
    """The tag of the robot with that ID."""
    arrow = f'<path id="front" d="M{MIDDLE - 40} {_top(ROBOT_TAG_SIZE) - 4} l8 -11 l8 11 z"/>'
    return _sheet(
        f"Robot {robot}",
        [
            *_tag(robot, ROBOT_TAG_SIZE),
            arrow,
            _text(MIDDLE - 18, _top(ROBOT_TAG_SIZE) - 6, f"front · robot {robot}", 8),
            *_lines(
                215,
                "Cut along the dashed line and glue the sheet flat onto stiff card.",
                "Mount it level on top of the robot: the arrow points forward, and the short marks",
                "at the sides point to the place between the wheels.",
                "Nothing may cover the black square or the white around it. Matt paper, no film.",
            ),
        ],
    )


def floor_sheet(number: int, pose: TagPose) -> str:
    """A floor tag that is to lie there."""
    return _sheet(
        f"Floor tag {number}",
        [
            *_tag(number, FLOOR_TAG_SIZE),
            _text(MIDDLE, _top(FLOOR_TAG_SIZE) - 10, f"floor tag {number} · this side towards y", 6, "middle"),
            _text(MIDDLE, _top(FLOOR_TAG_SIZE) - 3, _place(pose), 6, "middle"),
            *_lines(
                215,
                f"Its middle lies at {_place(pose)}, from the floor's corner 0, 0",
                "on the plan. A negative number is outside of that corner.",
                "The short marks at the sides point to its middle.",
                "Lay it at the floor's height, level, and glue all edges down. Matt paper, no film.",
            ),
        ],
    )


def plan_sheet(floor: Floor, tags: Mapping[int, TagPose]) -> str:
    """Where each floor tag goes."""
    left, lower = min(tag.x for tag in tags.values()), min(tag.y for tag in tags.values())
    right, upper = max(tag.x for tag in tags.values()), max(tag.y for tag in tags.values())
    x0, y0, width, height = PLAN
    scale = min(width / (right - left), height / (upper - lower))  # mm of paper for a m

    def at(x: float, y: float) -> tuple[float, float]:
        return x0 + (x - left) * scale, y0 + (upper - y) * scale

    drawn = []
    for x1, y1, x2, y2 in floor.walls:
        (from_x, from_y), (to_x, to_y) = at(x1, y1), at(x2, y2)
        drawn.append(f'<path class="wall" d="M{from_x:.2f} {from_y:.2f} L{to_x:.2f} {to_y:.2f}"/>')
    for number, tag in tags.items():
        x, y = at(tag.x, tag.y)
        drawn.append(f'<rect x="{x - 2:.2f}" y="{y - 2:.2f}" width="4" height="4"/>')
        drawn.append(_text(x, y + 7, str(number), 4, "middle"))
    x, y = at(0, 0)
    drawn.append(_text(x + 1.5, y - 1.5, "0, 0", 4))
    rows = [f"{number}: {_place(tag)}" for number, tag in tags.items()]
    top = y0 + (upper - lower) * scale + 20
    most = max(1, int((HEIGHT - 45 - top) / LINE))
    for index, row in enumerate(rows):
        drawn.append(_text(20 + 60 * (index // most), top + LINE * (index % most), row, 4.5))
    drawn.append(_text(20, 33, f"{floor.width:g} m x {floor.height:g} m; each tag's middle, from the corner 0, 0", 5))
    return _sheet("Where the floor tags lie", drawn)


def _sheet(title: str, drawn: Iterable[str]) -> str:
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}mm" height="{HEIGHT}mm" '
        f'viewBox="0 0 {WIDTH} {HEIGHT}">',
        f"<title>{escape(title)}</title>",
        "<style>text { font-family: sans-serif } .cut { fill: none; stroke: #000; stroke-width: .3; "
        "stroke-dasharray: 3 } .wall, .mark { fill: none; stroke: #000; stroke-width: .5 }</style>",
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>',
        _text(20, 22, title, 9),
        *drawn,
        *_scale(),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def _tag(number: int, size: float) -> list[str]:
    """Its black cells, `size` m wide in all, the line to cut along, and the marks of its middle."""
    cell = size * 1000 / CELLS
    cells = tag_picture(number)
    edge = cell * len(cells)
    left, top = MIDDLE - edge / 2, TAG_MIDDLE - edge / 2
    black = []
    for row, line in enumerate(cells):
        for column, white in enumerate(line):
            if not white:
                black.append(f"M{left + column * cell:g} {top + row * cell:g}h{cell:g}v{cell:g}h-{cell:g}z")
    right, upper = left + edge, top - STRIP
    marks = f"M{left} {TAG_MIDDLE}h4M{right} {TAG_MIDDLE}h-4M{MIDDLE} {top + edge}v-4M{MIDDLE} {top}v4"
    return [
        f'<path id="tag" shape-rendering="crispEdges" d="{"".join(black)}"/>',
        f'<rect class="cut" x="{left}" y="{upper}" width="{edge}" height="{edge + STRIP}"/>',
        f'<path class="mark" d="{marks}"/>',
    ]


def _top(size: float) -> float:
    """The upper edge of a tag's white border."""
    return TAG_MIDDLE - size * 1000 / CELLS * (CELLS + 2) / 2


def _scale() -> list[str]:
    """A line to measure."""
    left, y = MIDDLE - SCALE / 2, HEIGHT - 25
    ticks = "".join(f"M{left + tick} {y}v-{4 if tick % 50 == 0 else 2}" for tick in range(0, SCALE + 1, 10))
    text = f"This line is {SCALE} mm long. If it is not, print again at 100 %, without fitting to the page."
    return [
        f'<path id="scale" class="mark" d="M{left} {y}h{SCALE}"/>',
        f'<path class="mark" d="{ticks}"/>',
        _text(MIDDLE, y + 7, text, 4.2, "middle"),
    ]


def _lines(y: float, *texts: str) -> list[str]:
    return [_text(20, y + LINE * index, text, 4.5) for index, text in enumerate(texts)]


def _text(x: float, y: float, text: str, size: float, anchor: str = "start") -> str:
    return f'<text x="{x:.2f}" y="{y:.2f}" font-size="{size}" text-anchor="{anchor}">{escape(text)}</text>'


def _place(pose: TagPose) -> str:
    return f"x = {pose.x:.3f} m, y = {pose.y:.3f} m"
