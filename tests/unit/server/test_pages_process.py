"""The game server's part in the process of the pages."""

import sys
import threading

import pytest

from server.web.pages_process import PagesProcess
from tests.support.polling import until


def test_it_stops_after_a_vote_that_no_process_has_heard(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(sys, "executable", "/bin/false")  # it ends at once
    pages = PagesProcess()
    thread = threading.Thread(target=pages.run)
    thread.start()
    until(lambda: "has ended" in caplog.text, 10, "the process has ended")
    pages.tell(b"a vote\n")
    pages.stop()
    thread.join(10)
    assert not thread.is_alive()
