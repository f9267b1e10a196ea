"""`ci/setup` on a machine that lacks something: one clear line that says what to do."""

import contextlib
import os
import pty
import re
import select
import shutil
import signal
import subprocess
from collections.abc import Mapping
from pathlib import Path

import psutil
import pytest

from tests.support.polling import until
from tests.support.programs import ROOT

BUILT = shutil.ignore_patterns("build", ".venv", "node_modules", ".git", "__pycache__", ".*_cache", "bundle")


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """This project in a new folder, nothing built."""
    return Path(shutil.copytree(ROOT, tmp_path / "clone with space", ignore=BUILT))


def setup(clone: Path, variables: Mapping[str, str]) -> tuple[int, str]:
    run = subprocess.run(
        [clone / "ci" / "setup", "run"],
        env={**os.environ, **variables},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    return run.returncode, run.stderr.strip().splitlines()[-1] if run.stderr.strip() else ""


OFFLINE = {
    "PIP_CONFIG_FILE": os.devnull,
    "PIP_INDEX_URL": "http://127.0.0.1:9/",
    "PIP_EXTRA_INDEX_URL": "",
    "PIP_FIND_LINKS": "",
    "PIP_RETRIES": "0",
    "PIP_NO_CACHE_DIR": "1",
}
NO_NETWORK = "Setup stopped: the Python packages could not be installed (is the network up?)"


@pytest.mark.slow
def test_without_network_it_says_so_and_goes_on_next_time(clone: Path) -> None:
    for _ in range(2):  # what is half done the first time must not pass as done the second time
        code, line = setup(clone, OFFLINE)
        assert (code, line) == (1, NO_NETWORK)


@pytest.mark.slow
def test_a_virtual_environment_that_was_left_half_made_is_made_anew(clone: Path) -> None:
    subprocess.run(["/usr/bin/python3", "-m", "venv", "--without-pip", clone / ".venv"], check=True)
    assert setup(clone, OFFLINE) == (1, NO_NETWORK)
    assert (clone / ".venv" / "bin" / "pip").exists()


def test_on_another_system_than_debian_it_names_what_is_needed(clone: Path, tmp_path: Path) -> None:
    tools = tmp_path / "bin"
    tools.mkdir()
    for tool in ("sh", "dirname", "mkdir", "sed", "grep", "cat", "cksum"):
        (tools / tool).symlink_to(shutil.which(tool) or pytest.fail(f"{tool} is missing"))
    code, line = setup(clone, {"PATH": str(tools)})
    assert code == 1
    assert line.startswith("Setup stopped: this is not Debian. Debian 12 or 13 is needed, with: python3-venv")


def test_a_user_without_sudo_is_told_what_root_has_to_do(clone: Path, tmp_path: Path) -> None:
    tools = tmp_path / "bin"
    tools.mkdir()
    for tool in ("sh", "dirname", "mkdir", "sed", "grep", "cat", "cksum", "apt-get"):
        (tools / tool).symlink_to(shutil.which(tool) or pytest.fail(f"{tool} is missing"))
    (tools / "id").write_text("#!/bin/sh\necho 1000\n")
    (tools / "id").chmod(0o755)
    code, line = setup(clone, {"PATH": str(tools)})
    assert code == 1
    assert line.startswith("Setup stopped: packages are missing. As root: apt-get install --no-install-recommends")


def with_apt_get(script: str, folder: Path) -> dict[str, str]:
    """The environment of root on a Debian without our packages, whose apt-get is this shell script."""
    tools = folder / "bin"
    tools.mkdir()
    for tool, text in (("id", "echo 0"), ("dpkg-query", "exit 1"), ("apt-get", script)):
        (tools / tool).write_text(f"#!/bin/sh\n{text}\n")
        (tools / tool).chmod(0o755)
    return {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"}


def test_a_step_is_one_line_and_what_failed_shows_its_end(clone: Path, tmp_path: Path) -> None:
    lines = 'for line in 1 2 3 4 5 6 7 8 9 10 11; do echo "$1: line $line"; done; [ "$1" != install ]'
    run = subprocess.run(
        [clone / "ci" / "setup", "run"],
        env=with_apt_get(lines, tmp_path),
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert run.returncode == 1
    first, step = run.stdout.splitlines()
    assert first.startswith("The first time, this takes about ")
    assert re.fullmatch(r"Debian packages: \d+ s", step)
    told = run.stderr.strip().splitlines()
    assert told[0] == "This failed. The end of build/setup.log:"
    assert told[1] == "update: line 8"
    assert told[-3] == "install: line 11"
    assert told[-1].startswith(
        "Setup stopped: Debian's packages could not be installed (is the network up?): python3-venv"
    )
    assert "update: line 1\n" in (clone / "build" / "setup.log").read_text()


def test_in_a_terminal_the_seconds_run_and_end_with_ctrl_c(clone: Path, tmp_path: Path) -> None:
    terminal, its_end = pty.openpty()
    try:
        run = subprocess.Popen(
            [clone / "ci" / "setup", "run"],
            env=with_apt_get("exec sleep 60", tmp_path),
            stdin=subprocess.DEVNULL,
            stdout=its_end,
            stderr=its_end,
            start_new_session=True,
        )
        shown = b""

        def runs() -> bool:
            nonlocal shown
            if select.select([terminal], [], [], 0)[0]:
                shown += os.read(terminal, 4096)
            return re.search(rb"Debian packages: [1-9]\d* s", shown) is not None

        until(runs)
        os.killpg(run.pid, signal.SIGINT)
        assert run.wait(10) != 0
        until(lambda: not living(run.pid))
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(run.pid, signal.SIGKILL)
        os.close(its_end)
        os.close(terminal)


def living(session: int) -> list[psutil.Process]:
    """The processes of a session."""
    found = []
    for one in psutil.process_iter(["status"]):
        with contextlib.suppress(ProcessLookupError):
            if os.getsid(one.pid) == session and one.info["status"] != psutil.STATUS_ZOMBIE:
                found.append(one)
    return found
