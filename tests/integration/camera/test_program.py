"""The relay as a program: how it starts, ends, and what it does while ROS is away; and with the real ustreamer."""

import signal
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import pytest
import requests

from robot.camera.settings import NO_CAMERA
from tests.integration.camera.conftest import STOPPED, Relay, tell_camera
from tests.integration.rosbridge.ends import RosSide
from tests.support.fake_camera import FakeCamera
from tests.support.polling import LATEST, until
from tests.support.ports import free_port
from tests.support.programs import Program
from tests.support.ros import RosMaster
from tests.support.viewer import Viewer


@pytest.fixture
def eye() -> Iterator[FakeCamera]:
    with FakeCamera() as camera:
        yield camera


@pytest.mark.parametrize("sig", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_at_once_though_many_look(
    ros_master: RosMaster, referee: RosSide, eye: FakeCamera, sig: signal.Signals
) -> None:
    tell_camera(ros_master, 1, eye.url)
    with Relay(ros_master) as relay, ExitStack() as ends:
        viewers = [ends.enter_context(Viewer(relay.port)) for _ in range(20)]
        stuck = ends.enter_context(Viewer(relay.port, receive_buffer=4096))
        for each in (*viewers, stuck):
            each.watch(1)
        for each in viewers:
            each.picture()
            each.draws = False  # what is sent to a relay that has ended would cost its last word
        assert relay.program.stop(sig, seconds=2) == 0
        for each in viewers:
            with pytest.raises(ConnectionError, match="1001"):
                each.picture(lambda _: False)
    until(lambda: eye.streams == 0)


def test_no_more_viewers_than_are_allowed(ros_master: RosMaster, referee: RosSide) -> None:
    with Relay(ros_master, LASERBOT_RELAY_VIEWERS="4") as relay, ExitStack() as ends:
        viewers: list[Viewer] = []

        def is_full() -> bool:
            try:
                viewers.append(ends.enter_context(Viewer(relay.port)))
            except ConnectionError as error:
                assert "503" in str(error)
                return True
            return False

        assert [is_full() for _ in range(3)] == [False, False, True]  # one address has half
        for viewer in viewers:
            viewer.operate().metrics()
        assert [is_full() for _ in range(3)] == [False, False, True]
        assert requests.get(f"http://127.0.0.1:{relay.port}", timeout=LATEST).status_code == 426  # it is full, not sick
        viewers[-1].close()
        until(lambda: not is_full(), what="a place after another has left")


@pytest.mark.slow
def test_before_the_referee_has_spoken_only_operators_see(own_master: RosMaster, eye: FakeCamera) -> None:
    own_master.start()
    tell_camera(own_master, 1, eye.url)
    with Relay(own_master) as relay, Viewer(relay.port) as guest, Viewer(relay.port) as operator:
        guest.watch(1)
        assert guest.state("waiting") == "nothing has been heard from the referee yet"
        operator.operate().metrics()
        operator.watch(1)
        operator.picture()
        assert guest.sees_nothing_while(operator)
        referee = RosSide(own_master.env)
        try:
            referee.status(STOPPED)
            guest.state("live")
            guest.picture()
        finally:
            referee.close()


def test_while_the_master_hangs_pictures_go_on_and_who_comes_is_told(own_master: RosMaster, eye: FakeCamera) -> None:
    own_master.start()
    tell_camera(own_master, 1, eye.url)
    with Relay(own_master) as relay, Viewer(relay.port) as early, Viewer(relay.port) as late:
        for each in (early, late):
            each.operate().metrics()
        early.watch(1)
        early.picture()
        own_master.pause()
        try:
            late.watch(2)
            assert late.state("waiting") == "the camera is looked for"
            late.watch(1)
            late.picture()
            now = early.picture().number
            until(lambda: early.picture().number > now + 5, 10, "the pictures go on")
            assert relay.program.stop(signal.SIGTERM, seconds=3) == 0
        finally:
            own_master.resume()


@pytest.mark.slow
def test_when_the_master_was_restarted_it_finds_all_again(own_master: RosMaster, eye: FakeCamera) -> None:
    own_master.start()
    tell_camera(own_master, 1, eye.url)
    with Relay(own_master) as relay:
        with Viewer(relay.port) as viewer:
            viewer.operate().watch(1)
            viewer.picture()
        own_master.stop()
        own_master.start()
        until(lambda: relay.program.output.count("listening") == 2, 10, "the second beginning")
        with Viewer(relay.port) as viewer:
            viewer.operate().watch(1)
            viewer.state("none")  # the master has forgotten
            tell_camera(own_master, 1, eye.url)  # as the robot's serial node does, which ends with its master
            viewer.picture()


@pytest.mark.slow
def test_the_real_ustreamer_tells_that_its_camera_is_away_and_comes_back_when_started_again(
    ros_master: RosMaster, referee: RosSide
) -> None:
    port = free_port()
    tell_camera(ros_master, 5, f"http://127.0.0.1:{port}")
    with Relay(ros_master) as relay, Viewer(relay.port) as viewer:
        with robots_camera(ros_master, port):
            viewer.watch(5)
            shot = viewer.picture()
            assert shot.jpeg == NO_CAMERA.read_bytes()
            assert abs(shot.taken - time.time()) < 2
            assert viewer.states[-1] == (5, "waiting", "the camera is away")
            viewer.picture(lambda later: later.number > shot.number)
        assert viewer.waits("the camera cannot be reached")
        with robots_camera(ros_master, port):
            assert viewer.picture(lambda later: later.number > shot.number).jpeg == shot.jpeg


@contextmanager
def robots_camera(master: RosMaster, port: int) -> Iterator[None]:
    """The robot's own program, with ustreamer and without a device."""
    env = {"LASERBOT_MASTER": "127.0.0.1", "LASERBOT_CAMERA_PORT": str(port), "LASERBOT_CAMERA": "/dev/no-such-camera"}
    program = Program.python("robot.camera", env={**master.env, **env})
    try:
        program.wait_for(f"at port {port}")
        yield
    finally:
        program.stop()


def test_a_port_in_use_is_one_clear_line(ros_master: RosMaster) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        program = Program.python("server.camera", env={**ros_master.env, "LASERBOT_RELAY_PORT": str(port)})
        assert program.exit_code() == 1
    (line,) = program.output.splitlines()
    assert f"port {port}" in line
    assert "LASERBOT_RELAY_PORT" in line


def test_help_names_the_settings_and_an_impossible_one_is_one_clear_line() -> None:
    program = Program([sys.executable, "-m", "server.camera", "--help"], {"PYTHONPATH": "build/python"})
    assert program.exit_code() == 0
    assert "LASERBOT_RELAY_VIEWERS" in program.output
    program = Program.python("server.camera", env={"LASERBOT_RELAY_RATE": "fast"})
    assert program.exit_code() == 2
    assert program.output.startswith("python3 -m server.camera: LASERBOT_RELAY_RATE=fast: must be a whole number")
