"""The example page for any ROS 1 system, opened from a folder as its readers do."""

import shutil
from pathlib import Path

from playwright.sync_api import Browser

from tests.integration.rosbridge.documented import Lab, lab
from tests.support.programs import ROOT
from tests.support.ros import ros_master

__all__ = ["lab", "ros_master"]


def test_the_example_publishes_and_hears(chromium: Browser, lab: Lab, tmp_path: Path) -> None:
    shutil.copy(ROOT / "node_modules" / "roslib1" / "build" / "roslib.min.js", tmp_path)
    (tmp_path / "index.html").write_text(lab.example("html"))
    page = chromium.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    with page.expect_console_message(lambda message: message.text == "hello"):
        page.goto((tmp_path / "index.html").as_uri())
    assert complaints == []
    page.close()
