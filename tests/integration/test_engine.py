"""ci/engine: which Docker Engine it takes, what it says where there is none, and that a private one leaves nothing."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
import requests

from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program

ENGINE = str(ROOT / "ci/engine/run")
NO_ENGINE = {**os.environ, "DOCKER_HOST": "unix:///nowhere"}
needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root gets a private engine")


def test_without_an_engine_and_without_root_one_line_says_what_to_install(tmp_path: Path) -> None:
    # not every machine lets a test become somebody else: `id` says so instead
    (tmp_path / "id").write_text("#!/bin/sh\necho 12345\n")
    (tmp_path / "id").chmod(0o755)
    environment = {**NO_ENGINE, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    result = subprocess.run([ENGINE, "true"], env=environment, capture_output=True, text=True, check=False)
    assert result.returncode == 69
    (line,) = result.stderr.splitlines()
    assert "this is not root" in line
    assert "Install Docker" in line


def test_no_command_means_help() -> None:
    result = subprocess.run([ENGINE], capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert "ci/engine/run COMMAND" in result.stderr


def start(command: str = "exec sleep 300", **variables: str) -> Program:
    """An engine whose command runs on."""
    # a terminal's programs hear SIGHUP; those of `nohup make test` would not
    at_a_terminal = ["env", "--default-signal=HUP"]
    words = [*at_a_terminal, ENGINE, "sh", "-c", f"echo at $DOCKER_HOST end; {command}"]
    program = Program(words, {**NO_ENGINE, **variables})
    program.wait_for(" end", 120)
    assert processes_of(folder(program.output))
    return program


def folder(output: str) -> Path:
    """The private engine's, which is in the command lines of its processes."""
    return Path(re.search(r"unix://(/tmp/laserbot-engine[^/]+)/", output)[1])


def processes_of(engine: Path) -> list[str]:
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            if str(engine) in path.read_text(errors="replace"):
                found.append(path.read_text(errors="replace"))
    return found


def emulators() -> list[Path]:
    """The kernel's handlers that this checkout's engine has added."""
    handlers = Path("/proc/sys/fs/binfmt_misc").glob("laserbot-*")
    return [path for path in handlers if f"interpreter {ROOT}/" in path.read_text()]


@needs_root
def test_a_private_engine_runs_the_command_passes_its_exit_code_and_leaves_nothing() -> None:
    script = "echo at $DOCKER_HOST && docker info -f '{{.DriverStatus}}' && docker buildx version && exit 7"
    result = subprocess.run([ENGINE, "sh", "-c", script], env=NO_ENGINE, capture_output=True, text=True, check=False)
    assert result.returncode == 7, result.stderr
    assert "io.containerd.snapshotter" in result.stdout
    assert not folder(result.stdout).exists()
    assert not processes_of(folder(result.stdout))
    assert not emulators()


@needs_root
def test_inside_an_engine_that_can_do_it_that_one_is_used() -> None:
    inner = f"env -u IMAGES_ENGINE {ENGINE} sh -c 'echo inner $IMAGES_ENGINE'"
    result = subprocess.run([ENGINE, "sh", "-c", inner], env=NO_ENGINE, capture_output=True, text=True, check=False)
    assert "inner running" in result.stdout, result.stderr


@needs_root
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_engine_that_is_interrupted_leaves_nothing(sent: signal.Signals) -> None:
    program = start()
    try:
        os.killpg(program.process.pid, sent)  # as a terminal does
        until(lambda: not program.running, 30, "the end")
    finally:
        program.kill()
    assert program.process.returncode != 0
    assert not folder(program.output).exists()
    # the kernel ends them, a moment after their parent
    until(lambda: not processes_of(folder(program.output)), 10, "the end of what ran in it")
    assert not emulators()


@needs_root
def test_chosen_ports_of_a_private_engine_are_reached_through_the_systems() -> None:
    port = free_port()
    program = start(f"exec python3 -m http.server --bind 127.0.0.1 {port}", ENGINE_PORTS=str(port))

    def answers() -> bool:
        with contextlib.suppress(requests.ConnectionError):
            return requests.get(f"http://127.0.0.1:{port}", timeout=5).ok
        return False

    try:
        until(answers, 20)
    finally:
        program.stop(signal.SIGTERM)


@needs_root
def test_an_engine_that_is_killed_takes_every_process_with_it_and_the_next_one_cleans_up() -> None:
    program = start()
    engine = folder(program.output)
    program.process.kill()
    program.process.wait()
    until(lambda: not processes_of(engine), 10, "the end of the engine's processes")
    shutil.rmtree(engine)
    subprocess.run([ENGINE, "true"], env=NO_ENGINE, check=True)
    assert not emulators()
