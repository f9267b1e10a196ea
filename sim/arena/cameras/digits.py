"""Numbers of robots as strokes, readable from afar: no font is needed."""

from PIL import ImageDraw

# on a grid that is 2 wide and 4 high, from the top left; each digit is one or two lines
_STROKES: dict[str, tuple[tuple[tuple[float, float], ...], ...]] = {
    "0": (((0, 0), (2, 0), (2, 4), (0, 4), (0, 0)),),
    "1": (((0.3, 0.8), (1.2, 0), (1.2, 4)),),
    "2": (((0, 0), (2, 0), (2, 1.8), (0, 2.2), (0, 4), (2, 4)),),
    "3": (((0, 0), (2, 0), (2, 4), (0, 4)), ((0.5, 2), (2, 2))),
    "4": (((0.2, 0), (0, 2.6), (2, 2.6)), ((1.6, 1.2), (1.6, 4))),
    "5": (((2, 0), (0, 0), (0, 1.8), (2, 1.8), (2, 4), (0, 4)),),
    "6": (((2, 0), (0, 0), (0, 4), (2, 4), (2, 2), (0, 2)),),
    "7": (((0, 0), (2, 0), (0.8, 4)),),
    "8": (((0, 0), (2, 0), (2, 4), (0, 4), (0, 0)), ((0, 2), (2, 2))),
    "9": (((2, 2), (0, 2), (0, 0), (2, 0), (2, 4), (0, 4)),),
    "?": (((0, 0.6), (0, 0), (2, 0), (2, 1.8), (1, 1.9), (1, 2.7)), ((1, 3.9), (1, 4))),
}
_PITCH = 3.1  # of the grid, from one digit to the next


def draw_number(draw: ImageDraw.ImageDraw, text: str, middle: tuple[float, float], height: float, fill: str) -> None:
    """`text` of digits around a point; `height` in pixels."""
    unit = height / 4
    left = middle[0] - (len(text) * _PITCH - (_PITCH - 2)) / 2 * unit
    top = middle[1] - height / 2
    radius = 0.3 * unit
    for place, digit in enumerate(text):
        for stroke in _STROKES[digit]:
            points = [(left + (place * _PITCH + x) * unit, top + y * unit) for x, y in stroke]
            draw.line(points, fill, round(2 * radius), joint="curve")
            for x, y in (points[0], points[-1]):
                draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill)
