"""The documents are true: their commands are there, their links lead somewhere."""

import os
import re
import subprocess
from pathlib import Path

import pytest
import yaml

from tests.support.documents import page, table
from tests.support.programs import ROOT

DOCUMENTS = [path for path in [*ROOT.glob("*.md"), *ROOT.glob("*/*.md")] if not path.is_relative_to(ROOT / "build")]
COMMAND = re.compile(r"(?:[A-Z_]+=\S+ )?(?:make|docker|(?:\.\./)?ci/\w+|kubectl)\b.*|ansible-\w+ .+")
FENCE = re.compile(r"^ *```(\w*)\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)


def commands(text: str) -> set[str]:
    """The commands of a document: of its `sh` blocks, and between backquotes."""
    blocks = [block for language, block in FENCE.findall(text) if language == "sh"]
    lines = {line.split(" #")[0].strip() for block in blocks for line in block.splitlines()}
    spans = {" ".join(span.split()) for span in re.findall(r"`([^`]+)`", FENCE.sub("", text))}
    return lines | {span for span in spans if COMMAND.fullmatch(span)}


COMMANDS = sorted({command for document in DOCUMENTS for command in commands(document.read_text())})


@pytest.mark.parametrize("command", [command for command in COMMANDS if re.match(r"([A-Z_]+=\S+ )?make\b", command)])
def test_make_understands_the_command(command: str) -> None:
    words = command.replace("-C ..", "").split("make", 1)[1].split()
    result = make(*words, "--dry-run")
    assert result.returncode == 0, result.stderr


def test_profiles_and_playbooks_that_are_named_exist() -> None:
    services = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"].values()
    profiles = {profile for service in services for profile in service["profiles"]}
    for command in COMMANDS:
        assert set(re.findall(r"--profile[ =](\w+)", command)) <= profiles, command
        for playbook in re.findall(r"ansible-playbook\b.*?(\w+\.yml)", command):
            assert (ROOT / "ansible" / playbook).exists(), command


def test_all_ways_of_building_take_the_variables_of_the_packages() -> None:
    names = {row["variable"] for row in table(page("images.md"), "Debian's packages")}
    services = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"].values()
    for built in (service["build"]["args"] for service in services if "build" in service):
        assert built == {"IMAGE": built["IMAGE"], **{name: f"${{{name}:-}}" for name in names}}
    bake = (ROOT / "docker-bake.hcl").read_text()
    assert names <= set(re.findall(r"^    (\w+) += \1$", bake, re.MULTILINE))


def test_make_alone_lists_the_targets() -> None:
    result = make()
    assert result.returncode == 0
    listed = set(re.findall(r"^make ([\w-]+)", result.stdout, re.MULTILINE))
    assert {"demo", "test", "lint", "bench", "images", "clean"} <= listed
    for target in listed:
        assert make(target, "--dry-run").returncode == 0, target


def make(*words: str) -> subprocess.CompletedProcess[str]:
    """`make` as a user calls it, though a make may be running these tests."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
    return subprocess.run(["make", *words], cwd=ROOT, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_to_files_and_headings(document: Path) -> None:
    for target in re.findall(r"""(?:\]\(|src=")([^)"]+)""", FENCE.sub("", document.read_text())):
        if "://" in target:
            continue
        name, _, anchor = target.partition("#")
        path = document.parent / name if name else document
        assert path.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.*)$", path.read_text(), re.MULTILINE)
            assert anchor in {heading.lower().replace(" ", "-") for heading in headings}, target


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_that_are_named_exist(document: Path) -> None:
    """Between backquotes, from the repository's root or from the document's folder on."""
    others = re.compile("laser_bot_battle/[A-Z]|inventory/mine|backup/")  # names of types, and what the operator makes
    tops = {path.name for folder in (ROOT, document.parent) for path in folder.iterdir()} - {"build"}
    for path in re.findall(r"`([\w.-]+(?:/[\w.-]+)*/?)`", document.read_text()):
        if path.split("/")[0] in tops and not others.match(path):
            assert (ROOT / path).exists() or (document.parent / path).exists(), path


MAP = table(page("manual-map.md"), "From the tech manual to the files")


@pytest.mark.parametrize("row", MAP, ids=lambda row: row["section"])
def test_the_files_of_a_section_of_the_manual_exist(row: dict[str, str]) -> None:
    for path in row["here"].split(", "):
        assert (ROOT / path).exists(), path
