"""What a page weighs on the wire."""

from playwright.sync_api import Page


class Weight:
    """Counts the bytes of all answers to `page` and its frames, headers included, as they come from the network."""

    def __init__(self, page: Page) -> None:
        self.bytes = 0
        session = page.context.new_cdp_session(page)
        session.send("Network.enable")
        session.on("Network.loadingFinished", self._count)

    def _count(self, event: dict[str, float]) -> None:
        self.bytes += int(event["encodedDataLength"])
