"""What a page weighs on the wire."""

from typing import Any

from playwright.sync_api import Page

LOOK = 500  # ms between two looks
QUIET = 4  # looks in a row
LOOKS = 240  # then nothing will settle any more


class Weight:
    """Counts the bytes of all answers to `page` and its frames, headers included, as they come from the network."""

    def __init__(self, page: Page) -> None:
        self.bytes = 0
        self._page = page
        self._addresses: set[str] = set()
        session = page.context.new_cdp_session(page)
        session.on("Network.requestWillBeSent", self._asked)
        session.on("Network.loadingFinished", self._answered)
        session.send("Network.enable")

    def _asked(self, event: dict[str, Any]) -> None:
        self._addresses.add(event["request"]["url"])

    def _answered(self, event: dict[str, Any]) -> None:
        self.bytes += int(event["encodedDataLength"])

    def settled(self) -> int:
        """The bytes, as soon as the page asks for nothing new; AssertionError when there is no end of it.

        Playwright's "networkidle" counts what is asked again and again, too: a busy machine never gets there.
        """
        quiet, before = 0, 0
        for _ in range(LOOKS):
            self._page.wait_for_timeout(LOOK)
            quiet = quiet + 1 if len(self._addresses) == before else 0
            if quiet == QUIET:
                return self.bytes
            before = len(self._addresses)
        raise AssertionError(f"still loading after {self.bytes} bytes")
