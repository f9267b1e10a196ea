"""ci/engine: which Docker Engine it takes, what it says where there is none, and that a private one leaves nothing."""

import contextlib
import fcntl
import os
import re
import shutil
import signal
import struct
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest
import requests

from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import ROOT, Program

ENGINE = str(ROOT / "ci/engine/run")
NO_ENGINE = {**os.environ, "DOCKER_HOST": "unix:///nowhere"}
BINFMT = Path("/proc/sys/fs/binfmt_misc")
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


def start(command: str = "exec sleep 300", engine: str = ENGINE, **variables: str) -> Program:
    """An engine whose command runs on."""
    # a terminal's programs hear SIGHUP; those of `nohup make test` would not
    at_a_terminal = ["env", "--default-signal=HUP"]
    words = [*at_a_terminal, engine, "sh", "-c", f"echo at $DOCKER_HOST end; {command}"]
    program = Program(words, {**NO_ENGINE, **variables})
    program.wait_for(" end", 120)
    assert processes_of(folder(program.output))
    return program


def folder(output: str) -> Path:
    """The private engine's, which is in the command lines of its processes."""
    return Path(re.findall(r"unix://(/tmp/laserbot-engine[^/]+)/", output)[0])


def processes_of(engine: Path) -> list[psutil.Process]:
    return [process for process in psutil.process_iter(["cmdline"]) if str(engine) in str(process.info["cmdline"])]


def emulators_left() -> list[Path]:
    """The kernel's handlers of engines that are gone: while one of another folder runs, they are its."""
    with contextlib.suppress(FileNotFoundError, BlockingIOError), (BINFMT / "status").open() as reference:
        fcntl.flock(reference, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return list(BINFMT.glob("laserbot-*"))
    return []


@pytest.mark.slow
@needs_root
def test_a_private_engine_runs_the_command_passes_its_exit_code_and_leaves_nothing() -> None:
    script = "echo at $DOCKER_HOST && docker info -f '{{.DriverStatus}}' && docker buildx version && exit 7"
    result = subprocess.run([ENGINE, "sh", "-c", script], env=NO_ENGINE, capture_output=True, text=True, check=False)
    assert result.returncode == 7, result.stderr
    assert "io.containerd.snapshotter" in result.stdout
    assert not folder(result.stdout).exists()
    assert not processes_of(folder(result.stdout))
    assert not emulators_left()
    assert "full" not in result.stderr


@pytest.mark.slow
@needs_root
def test_whose_command_fails_on_a_full_disk_reads_that_last(tmp_path: Path) -> None:
    (tmp_path / "df").write_text("#!/bin/sh\nprintf 'Avail\\n  40\\n'\n")
    (tmp_path / "df").chmod(0o755)
    environment = {**NO_ENGINE, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    result = subprocess.run([ENGINE, "false"], env=environment, capture_output=True, text=True, check=False)
    assert result.returncode == 1
    assert "disk is full: 40 MB are left" in result.stderr.splitlines()[-1]


@pytest.mark.slow
@needs_root
def test_inside_an_engine_that_can_do_it_that_one_is_used() -> None:
    inner = f"env -u IMAGES_ENGINE {ENGINE} sh -c 'echo inner $IMAGES_ENGINE'"
    result = subprocess.run([ENGINE, "sh", "-c", inner], env=NO_ENGINE, capture_output=True, text=True, check=False)
    assert "inner running" in result.stdout, result.stderr


@pytest.mark.slow
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
    assert not emulators_left()


@pytest.mark.slow
@needs_root
def test_chosen_ports_of_a_private_engine_are_reached_through_the_systems() -> None:
    port = free_port()
    program = start(f"exec python3 -m http.server --bind 127.0.0.1 {port}", ENGINE_PORTS=str(port))

    def answers() -> bool:
        with contextlib.suppress(requests.ConnectionError):
            return requests.get(f"http://127.0.0.1:{port}", timeout=LATEST).ok
        return False

    try:
        until(answers, 20)
    finally:
        program.stop(signal.SIGTERM)


@pytest.mark.slow
@needs_root
def test_an_engine_that_is_killed_takes_every_process_with_it_and_the_next_one_cleans_up() -> None:
    program = start()
    engine = folder(program.output)
    program.process.kill()
    program.process.wait()
    until(lambda: not processes_of(engine), 10, "the end of the engine's processes")
    shutil.rmtree(engine)
    subprocess.run([ENGINE, "true"], env=NO_ENGINE, check=True)
    assert not emulators_left()


@pytest.fixture
def other_engine() -> Iterator[str]:
    """ci/engine/run of another folder, where Docker's packages have been unpacked, too."""
    subprocess.run([ROOT / "ci/engine/packages"], check=True)
    # not every file system can hold an engine's data, such as that of a temporary folder
    with tempfile.TemporaryDirectory(dir=ROOT / "build", prefix="engine-") as name:
        here, other = ROOT / "build/engine", Path(name, "build/engine")
        shutil.copytree(ROOT / "ci/engine", Path(name, "ci/engine"))
        other.mkdir(parents=True)
        for part in ("root", "bin", "client"):
            (other / part).symlink_to(here / part)
        (other / "recipe").write_text((here / "recipe").read_text().replace(str(here), str(other)))
        yield f"{name}/ci/engine/run"


def arm_program(path: Path) -> Path:
    """An ELF file for Linux on a 32-bit arm: exit(42)."""
    code = struct.pack("<3I", 0xE3A07001, 0xE3A0002A, 0xEF000000)  # mov r7, #1; mov r0, #42; svc 0
    start, size = 0x10000, 52 + 32 + len(code)
    header = struct.pack("<16s2H5I6H", b"\x7fELF\1\1\1", 2, 40, 1, start + 84, 52, 0, 0x5000000, 52, 32, 1, 0, 0, 0)
    path.write_bytes(header + struct.pack("<8I", 1, 0, start, start, size, size, 5, 4096) + code)
    path.chmod(0o755)
    return path


@pytest.mark.slow
@needs_root
@pytest.mark.parametrize("ends_first", [0, 1])
def test_of_two_engines_side_by_side_only_the_last_one_out_takes_the_emulators(
    other_engine: str, tmp_path: Path, ends_first: int
) -> None:
    program = arm_program(tmp_path / "arm")
    engines = [start(), start(engine=other_engine)]
    try:
        engines.pop(ends_first).stop(signal.SIGTERM)
        assert subprocess.run([program], check=False).returncode == 42
    finally:
        for engine in engines:
            engine.stop(signal.SIGTERM)
    assert not emulators_left()
