"""What axe-core, which knows the rules for accessible pages, has against a page."""

import itertools
from collections.abc import Iterator
from functools import cache
from typing import Any, Literal

from playwright.sync_api import Page

from tests.support.programs import ROOT

SIZES = {"desktop": (1280, 800), "phone": (390, 844)}
Theme = Literal["dark", "light"]
KINDS: list[tuple[str, Theme]] = [("desktop", "dark"), ("phone", "light"), ("desktop", "light"), ("phone", "dark")]


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


def show(page: Page, size: str, theme: Theme) -> None:
    """On a screen of that size, without motion."""
    width, height = SIZES[size]
    page.set_viewport_size({"width": width, "height": height})
    page.emulate_media(color_scheme=theme, reduced_motion="reduce")


class Looks:
    """What axe-core has against the states of the pages that it was shown: each on one kind of screen, the next kind
    for the next state, or on all."""

    def __init__(self, *, thorough: bool) -> None:
        self.found: dict[str, list[str]] = {}
        self.thorough = thorough
        self._kinds = None if thorough else itertools.cycle(KINDS)

    def all(self, page: Page, state: str) -> None:
        for how in self.at(page):
            self.found[f"{state}, {how}"] = violations(page)

    def at(self, page: Page) -> Iterator[str]:
        """Show the page on each kind of screen; each time its name, like "phone-dark"."""
        for size, theme in KINDS if self._kinds is None else [next(self._kinds)]:
            show(page, size, theme)
            yield f"{size}-{theme}"

    def once(self, page: Page, state: str) -> None:
        """At what goes by too fast for every kind."""
        self.found[state] = violations(page)
