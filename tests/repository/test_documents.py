"""The documents are true: their commands are run somewhere, their links lead somewhere."""

import os
import re
import subprocess
from pathlib import Path

import pytest

from tests.support.documents import page, table
from tests.support.programs import ROOT

DOCUMENTS = [path for path in [*ROOT.glob("*.md"), *ROOT.glob("*/*.md")] if not path.is_relative_to(ROOT / "build")]
COMMAND = re.compile(r"(?:[A-Z_]+=\S+ )?(?:make|docker|(?:\.\./)?ci/\w+|kubectl)\b.*|ansible-\w+ .+")
FENCE = re.compile(r"^ *```(\w*)\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)

INVENTORY = "tests/repository/test_ansible_readme.py::test_its_steps_make_an_inventory"

# Who runs each command of these documents: a test, or a workflow or script with the words.
RUN_BY = {
    "README.md": {
        "make demo": "tests/integration/test_demo.py::test_make_demo_starts_and_ctrl_c_ends_it",
        "make demo BOTS=0": "tests/integration/test_battle.py::test_a_command_turns_the_wheels_and_silence_stops_them",
        "make demo ROBOTS=4 BOTS=2": "tests/integration/test_demo.py::test_make_demo_starts_and_ctrl_c_ends_it",
        "LASERBOT_BIND=0.0.0.0 make demo": "tests/integration/discovery/test_demo.py::test_others_reach_the_game",
        "make images": "tests/images/test_contents.py::test_each_image_has_a_list_of_its_contents",
        "docker compose --profile demo up": "tests/images/test_compose.py::test_a_battle_is_played_to_its_end",
        "make fleet": "ci/test-fleet::ci/fleet up",
        "make test": ".ci/run::exec make test",
        "make lint": ".github/workflows/ci.yml::run: make lint",
        "make bench": ".github/workflows/ci.yml::run: make bench",
        "make": "tests/repository/test_documents.py::test_make_alone_lists_the_targets",
    },
    "docs/images.md": {
        "make images": "tests/images/test_contents.py::test_each_image_has_a_list_of_its_contents",
        "make images PUSH=registry:port": "tests/images/test_delivery.py"
        "::test_a_registry_gets_every_platform_under_one_name",
        "make images ARCHIVE=laserbot.tar": "tests/images/test_delivery.py::test_an_archive_carries_every_platform",
        "docker load -i laserbot.tar": "tests/images/test_delivery.py::test_an_archive_carries_every_platform",
        "make images PLATFORM=linux/arm/v7 ARCHIVE=robot.tar": "tests/images/test_delivery.py"
        "::test_an_archive_for_one_platform_loads_on_an_engine_of_the_older_kind",
        "ENGINE_PORTS=5000,8080,9090,9091 ci/engine/run docker compose --profile demo up": ""
        "tests/integration/test_engine.py::test_chosen_ports_of_a_private_engine_are_reached_through_the_systems",
    },
    "docs/lan.md": {
        "make demo": "tests/integration/test_demo.py::test_make_demo_starts_and_ctrl_c_ends_it",
        "make bench": ".github/workflows/ci.yml::run: make bench",
        "docker compose --profile master up -d": "tests/images/test_compose_lan.py"
        "::test_robots_find_the_master_and_a_battle_is_played",
        "docker compose --profile robot up -d": "tests/images/test_compose_lan.py"
        "::test_robots_find_the_master_and_a_battle_is_played",
    },
    "docs/monitoring.md": {
        "docker compose --profile master --profile monitoring up": "tests/images/test_compose_lan.py"
        "::test_a_program_that_stops_is_an_alert",
        "make demo": "tests/integration/test_demo.py::test_make_demo_starts_and_ctrl_c_ends_it",
        "prometheus --config.file=monitoring/prometheus.yml --web.listen-address=127.0.0.1:9210 "
        "--storage.tsdb.path=/var/lib/prometheus": "tests/integration/test_monitoring.py"
        "::test_every_query_of_the_dashboard_has_an_answer",
        "prometheus-alertmanager --config.file=monitoring/alertmanager.yml --web.listen-address=127.0.0.1:9211 "
        "--cluster.listen-address=": "tests/images/test_compose_lan.py::test_a_program_that_stops_is_an_alert",
    },
    "docs/rosbridge.md": {
        "ci/setup run": "Makefile::ci/setup run",
        "PYTHONPATH=build/python:$PYTHONPATH .venv/bin/python -m server.rosbridge --port 9090 --open": "tests"
        "/integration/rosbridge/test_documented_lab.py::test_the_python_example_runs",
    },
    "docs/replace-the-master.md": {
        f"ansible-playbook -i inventory/mine {verb} --ask-vault-pass": "tests/fleet/faults/test_host_is_replaced.py"
        "::test_the_masters_card_is_replaced"
        for verb in ("backup.yml", "restore.yml -e backup=$PWD/backup/DATE-TIME.tar")
    },
    "ansible/README.md": {
        "make fleet": "ci/test-fleet::ci/fleet up",
        "make fleet-down": "ci/test-fleet::ci/fleet down",
        "cd ansible": INVENTORY,
        "cp -r inventory/example inventory/mine": INVENTORY,
        "cd inventory/mine/group_vars/all && mv vault.example.yml vault.yml && cd -": INVENTORY,
        "ansible-vault encrypt inventory/mine/group_vars/all/vault.yml": INVENTORY,
        "ci/setup fleet": "Makefile::ci/setup fleet",
        "make images ARCHIVE=build/images.tar": "tests/images/test_delivery.py::test_an_archive_carries_every_platform",
        "make -C .. images ARCHIVE=build/images.tar": "tests/images/test_delivery.py"
        "::test_an_archive_carries_every_platform",
        "ansible-playbook -i inventory/mine deploy.yml --ask-vault-pass": "ci/fleet::play deploy",
        "ansible-playbook -i inventory/mine check.yml --ask-vault-pass": "tests/fleet/test_deploy.py"
        "::test_the_operators_checks_pass",
    },
}
RUNS = {command: place for document in RUN_BY.values() for command, place in document.items()}


def commands(text: str) -> set[str]:
    """The commands of a document: of its `sh` blocks, and between backquotes."""
    blocks = [block for language, block in FENCE.findall(text) if language == "sh"]
    lines = {line.split(" #")[0].strip() for block in blocks for line in block.splitlines()}
    spans = {" ".join(span.split()) for span in re.findall(r"`([^`]+)`", FENCE.sub("", text))}
    return lines | {span for span in spans if COMMAND.fullmatch(span)}


@pytest.mark.parametrize("document", RUN_BY)
def test_every_command_is_run_by_a_test_or_by_ci(document: str) -> None:
    assert commands((ROOT / document).read_text()) == set(RUN_BY[document])


@pytest.mark.parametrize("command", RUNS)
def test_what_runs_a_command_is_there(command: str) -> None:
    path, where = RUNS[command].split("::")
    text = (ROOT / path).read_text()
    assert f"def {where}(" in text if path.endswith(".py") else where in text


@pytest.mark.parametrize("command", [command for command in RUNS if re.search(r"\bmake\b", command)])
def test_make_understands_the_command(command: str) -> None:
    words = command.replace("-C ..", "").split("make", 1)[1].split()
    result = make(*words, "--dry-run")
    assert result.returncode == 0, result.stderr


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


# The manual's chapters with text of their own, and its sections.
MANUAL = """
1 2.1 2.1.1 2.1.2 2.1.3 2.2 2.3 2.4 2.5
3.1 3.1.1 3.1.2 3.1.3 3.1.3.1 3.1.3.2 3.1.3.3 3.1.3.4 3.1.3.5 3.1.3.6 3.1.3.7 3.1.3.8 3.1.3.9 3.1.4 3.1.4.1 3.1.4.2
3.1.5 3.1.5.1 3.1.5.2
3.2 3.2.1 3.2.2 3.2.3 3.2.3.1 3.2.4 3.2.4.1 3.2.4.2 3.2.5 3.2.5.1 3.2.5.2 3.2.5.3 3.2.5.4 3.2.5.5 3.2.5.6 3.2.5.7
3.2.5.8
4.1 4.2 4.3 4.4 4.5 4.5.1 4.5.2 4.5.3 5.1 5.1.1 6.1 6.2 6.2.1 6.2.2 6.2.3 6.3
"""


def test_the_map_has_the_manuals_sections() -> None:
    assert [row["section"] for row in MAP] == MANUAL.split()
