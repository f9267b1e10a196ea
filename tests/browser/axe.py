"""What axe-core, which knows the rules for accessible pages, has against a page."""

from collections.abc import Iterator
from functools import cache
from typing import Any, Literal

from playwright.sync_api import Page

from tests.support.programs import ROOT

SIZES = {"desktop": (1280, 800), "phone": (390, 844)}
THEMES: tuple[Literal["dark", "light"], ...] = ("dark", "light")


@cache
def _source() -> str:
    return (ROOT / "node_modules" / "axe-core" / "axe.min.js").read_text()


def violations(page: Page) -> list[str]:
    """A line for each element that breaks a rule. The page itself loads nothing: its policy would forbid that."""
    if not page.evaluate("Boolean(window.axe)"):
        page.evaluate(_source())
    found: list[dict[str, Any]] = page.evaluate("axe.run().then(({ violations }) => violations)")
    return [
        f"{rule['id']}: {' '.join(map(str, node['target']))}: {' '.join(node['failureSummary'].split())}"
        for rule in found
        for node in rule["nodes"]
    ]


def looks(page: Page) -> Iterator[str]:
    """Show the page on each size of screen, dark and light, without motion; each time its name, like "phone-dark"."""
    for size, (width, height) in SIZES.items():
        page.set_viewport_size({"width": width, "height": height})
        for theme in THEMES:
            page.emulate_media(color_scheme=theme, reduced_motion="reduce")
            yield f"{size}-{theme}"
