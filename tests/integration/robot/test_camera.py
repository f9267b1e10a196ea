"""The robot's camera program with the real ustreamer, and who gets its pictures."""

import shutil
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil
import pytest
import requests

from laser_bot_battle.master import Master
from robot.camera.settings import NO_CAMERA, find_libcamera
from tests.integration.robot.device import Device
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster

# Stands for ustreamer with a camera: the first line that it prints, once it listens, are its arguments.
STAND_IN = """#!{python}
import socket, sys
(path,) = [word.partition("=")[2] for word in sys.argv if word.startswith("--unix=")]
server = socket.socket(socket.AF_UNIX)
server.bind(path)
server.listen()
print(" ".join(["ARGUMENTS", *sys.argv[1:]]), flush=True)
while True:
    guest, _ = server.accept()
    words = guest.recv(4096).split()
    print("ASKED", words[1].decode(), flush=True)
    guest.sendall(b"HTTP/1.0 200 OK\\r\\n\\r\\n")
    try:
        while words[1].startswith(b"/stream"):
            guest.sendall(b"picture " * 1000)
    except OSError:
        print("GONE", flush=True)
    guest.close()
"""


@contextmanager
def camera(**environ: str) -> Iterator[tuple[Program, str]]:
    """The program and its address."""
    port = free_port()
    env = {"LASERBOT_MASTER": "127.0.0.1", "LASERBOT_CAMERA_PORT": str(port), **environ}
    program = Program.python("robot.camera", env=env)
    try:
        program.wait_for(f"at port {port}")
        yield program, f"http://127.0.0.1:{port}"
        if program.process.poll() is None:
            assert program.stop() == 0
    finally:
        program.kill()


@pytest.fixture
def stand_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "ustreamer"
    path.write_text(STAND_IN.format(python=sys.executable))
    path.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")


def answer(url: str) -> requests.Response:
    return requests.get(url, timeout=LATEST)


def test_without_a_camera_the_picture_says_so() -> None:
    assert shutil.which("ustreamer")
    with camera(LASERBOT_CAMERA="/dev/no-such-camera") as (_, address):
        until(lambda: answer(f"{address}/snapshot").status_code == 200, 20, "ustreamer")
        still = answer(f"{address}/snapshot")
        assert still.content == NO_CAMERA.read_bytes()
        assert answer(f"{address}/state").json()["result"]["source"]["online"] is False


def test_a_stream_is_ustreamers_own_and_says_that_the_camera_is_away() -> None:
    with camera(LASERBOT_CAMERA="/dev/no-such-camera") as (_, address):
        until(lambda: answer(f"{address}/snapshot").status_code == 200, 20, "ustreamer")
        with requests.get(f"{address}/stream?extra_headers=1", stream=True, timeout=LATEST) as stream:
            assert stream.headers["Content-Type"].startswith("multipart/x-mixed-replace")
            head = stream.raw.read(600)
    assert b"X-Timestamp: " in head
    assert b"X-UStreamer-Online: false" in head


@pytest.mark.usefixtures("stand_in")
def test_settings_reach_ustreamer() -> None:
    with camera(
        LASERBOT_CAMERA="/dev/video7",
        LASERBOT_CAMERA_SIZE="320x240",
        LASERBOT_CAMERA_RATE="30",
        LASERBOT_CAMERA_QUALITY="50",
    ) as (program, _):
        program.wait_for("ARGUMENTS")
        (line,) = [line for line in program.output.splitlines() if line.startswith("ARGUMENTS")]
        wanted = {"--device=/dev/video7", "--resolution=320x240", "--desired-fps=30", "--quality=50", "--format=MJPEG"}
        assert wanted <= set(line.split())


@pytest.mark.parametrize("place", ["usr/libexec/aarch64-linux-gnu/libcamera", "usr/lib/arm-linux-gnueabihf"])
def test_the_raspberry_pis_own_camera_goes_through_libcamera(place: str, tmp_path: Path) -> None:
    assert find_libcamera(tmp_path) is None
    library = tmp_path / place / "v4l2-compat.so"
    library.parent.mkdir(parents=True)
    library.touch()
    assert find_libcamera(tmp_path) == library


def test_a_missing_library_is_named() -> None:
    port = str(free_port())
    program = Program.python("robot.camera", env={"LASERBOT_CAMERA": "libcamera", "LASERBOT_CAMERA_PORT": port})
    try:
        program.wait_for(f"at port {port}" if find_libcamera() else "apt-get install libcamera-v4l2 libcamera-ipa")
    finally:
        program.kill()


@pytest.mark.usefixtures("stand_in")
def test_pictures_pass_and_nobody_looks_when_the_master_has_left() -> None:
    with camera(LASERBOT_CAMERA="/dev/video0") as (program, address):
        program.wait_for("ARGUMENTS")
        with requests.get(f"{address}/stream?extra_headers=1", stream=True, timeout=LATEST) as stream:
            assert stream.raw.read(100_000) == b"picture " * 12_500
        program.wait_for("ASKED /stream?extra_headers=1")
        program.wait_for("GONE")


@pytest.mark.usefixtures("stand_in")
def test_nobody_but_the_master_gets_pictures() -> None:
    # the master is elsewhere: what comes from this machine is a stranger
    with camera(LASERBOT_CAMERA="/dev/video0", LASERBOT_MASTER="127.0.0.9") as (program, address):
        program.wait_for("ARGUMENTS")
        for path in ("stream", "snapshot", "state"):
            refusal = answer(f"{address}/{path}")
            assert (refusal.status_code, refusal.text) == (403, "only the master gets this robot's pictures\n")
        program.wait_for("127.0.0.1 wanted pictures: refused, it is not the master")
        assert "ASKED" not in program.output


@pytest.mark.usefixtures("stand_in")
@pytest.mark.parametrize(
    "request_text",
    [
        b"GET / HTTP/1.1\r\n\r\n",
        b"GET /../etc/passwd HTTP/1.1\r\n\r\n",
        b"POST /stream HTTP/1.1\r\n\r\n",
        b"\xff\xfe\r\n\r\n",
    ],
)
def test_ustreamers_other_pages_are_not_there(request_text: bytes) -> None:
    with camera(LASERBOT_CAMERA="/dev/video0") as (program, address):
        program.wait_for("ARGUMENTS")
        with socket.create_connection(("127.0.0.1", int(address.rpartition(":")[2])), 10) as guest:
            guest.sendall(request_text)
            assert b" 404 " in guest.recv(1000)
            guest.sendall(b"x")
        with socket.create_connection(("127.0.0.1", int(address.rpartition(":")[2])), 10) as guest:
            guest.sendall(b"GET /stream HTTP/1.1\r\nX: " + b"x" * 10_000)
            with suppress(ConnectionResetError):
                assert guest.recv(1) == b""
        assert "ASKED" not in program.output


@pytest.mark.usefixtures("stand_in")
def test_the_program_ends_with_ustreamer_and_ustreamer_with_the_program() -> None:
    with camera(LASERBOT_CAMERA="/dev/video0") as (program, _):
        program.wait_for("ARGUMENTS")
        (child,) = psutil.Process(program.process.pid).children()
        child.kill()
        assert program.exit_code() == 1
        assert "ustreamer has ended (-9)" in program.output
    with camera(LASERBOT_CAMERA="/dev/video0") as (program, address):
        program.wait_for("ARGUMENTS")
        (child,) = psutil.Process(program.process.pid).children()
        with requests.get(f"{address}/stream", stream=True, timeout=LATEST) as stream:
            stream.raw.read(1000)
            assert program.stop() == 0
        until(lambda: not psutil.pid_exists(child.pid), 10, "the end of ustreamer")


def test_a_port_in_use_and_a_wrong_setting_are_one_clear_line() -> None:
    with socket.create_server(("", 0)) as other:
        port = str(other.getsockname()[1])
        program = Program.python("robot.camera", env={"LASERBOT_MASTER": "127.0.0.1", "LASERBOT_CAMERA_PORT": port})
        assert program.exit_code() == 1
        assert f"cannot listen on port {port}" in program.output
        assert "LASERBOT_CAMERA_PORT" in program.output
    program = Program.python("robot.camera", env={"LASERBOT_CAMERA_SIZE": "big"})
    assert program.exit_code() == 2
    assert "LASERBOT_CAMERA_SIZE=big: must be width x height, such as 640x480" in program.output


def test_the_serial_node_tells_the_master_where_the_camera_is(device: Device, ros_master: RosMaster) -> None:
    master = Master(ros_master.uri, "test")

    def told(**environ: str) -> str | None:
        node = Program.python("robot.serial_node", device.path, "__name:=Robot45", env={**ros_master.env, **environ})
        try:
            node.wait_for("/Robot45 serves")
            return master.call("getParam", "/Robot45/camera") if master.call("hasParam", "/Robot45/camera") else None
        finally:
            node.kill()

    assert told(LASERBOT_CAMERA="/dev/video0", LASERBOT_CAMERA_PORT="8123") == "http://127.0.0.1:8123"
    assert told() is None
    assert told(LASERBOT_CAMERA_URL="http://127.0.0.1:8080/eyes/virtual0") == "http://127.0.0.1:8080/eyes/virtual0"
