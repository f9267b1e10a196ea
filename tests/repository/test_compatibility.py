"""docs/compatibility.md names what the tests really run."""

import json
import re

from tests.integration.rosbridge.other_clients import CLIENTS
from tests.support.documents import page, table
from tests.support.programs import ROOT

ROWS = table(page("compatibility.md"), "Clients and suites")


def names_of(registry: str) -> set[tuple[str, str]]:
    return {(row["client"].split("'s own")[0], row["version"]) for row in ROWS if row["from"] == registry}


def test_the_clients_from_npm_are_those_that_the_tests_install() -> None:
    installed = json.loads((ROOT / "package.json").read_text())["devDependencies"]
    clients = {name: version for name, version in installed.items() if "roslib" in name}
    # a second version of a package has another name here: "npm:roslib@1.4.1"
    assert names_of("npm") == {
        tuple(version.removeprefix("npm:").rsplit("@", 1)) if "@" in version else (name, version)
        for name, version in clients.items()
    }


def test_the_client_from_pypi_and_its_suite_are_of_the_version_that_the_tests_install() -> None:
    pinned = {
        found
        for name in ("test.txt", "suites.txt")
        for found in re.findall(r"^(roslibpy)==(\S+)", (ROOT / "requirements" / name).read_text(), re.MULTILINE)
    }
    assert names_of("PyPI") == pinned


def test_the_clients_tried_by_frames_are_those_of_the_test() -> None:
    tried = {row["client"].split(" ")[0] for row in ROWS if row["tried with"].startswith("frames")}
    assert tried == {client.name for client in CLIENTS}
