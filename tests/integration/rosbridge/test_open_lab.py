"""rosbridge open to everybody, as in a lab, with other people's client libraries and message packages."""

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from laser_bot_battle.master import Master
from tests.integration.rosbridge.client_programs import told_by
from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.other_clients import CLIENTS, Client, Speaker
from tests.support.polling import until
from tests.support.programs import ROOT, Program
from tests.support.ros import RosMaster
from tests.support.roslib_player import NODE

HERE = ROOT / "tests" / "integration" / "rosbridge"
PREEMPTED, SUCCEEDED = 2, 3  # actionlib_msgs/GoalStatus
NUMBERS = [0.5, -2.0, 1e6]
TOLD = {
    "said": 21,
    "none": NUMBERS,
    "calls": {"success": True, "message": "grüß Gott"},
    "serves": {"success": True, "message": "from the page"},
    "param": {"speeds": [1, 2.5], "name": "zwölf"},
    "param is left": False,
    "type": "std_msgs/String",
    "node": True,
    "action": [[1, 2, 3], SUCCEEDED, 3],
    "cancelled": PREEMPTED,
    "acts": [[1], SUCCEEDED, 3],
    "tf": 1.5,
    "tf topic": "robot",
}


@pytest.fixture(scope="module")
def message_path(ros_master: RosMaster, tmp_path_factory: pytest.TempPathFactory) -> str:
    """PYTHONPATH with the message packages tf2_web_republisher and rospy_tutorials, which Debian has not."""
    folder = tmp_path_factory.mktemp("messages")
    includes = [f"-I{name}:/usr/share/{name}/msg" for name in ("std_msgs", "geometry_msgs", "actionlib_msgs")]
    for sources in (HERE / "tf2_web_republisher/msg", HERE / "tf2_web_republisher/srv", HERE / "rospy_tutorials/srv"):
        package, kind = sources.parent.name, sources.name
        command = ["/usr/bin/python3", f"/usr/lib/genpy/gen{kind}_py.py"]
        target = ["-p", package, "-o", str(folder / package / kind)]
        files = sorted(map(str, sources.iterdir()))
        subprocess.run([*command, *files, f"-I{package}:{sources.parent / 'msg'}", *includes, *target], check=True)
        subprocess.run([*command, "--initpy", *target], check=True)
    return f"{folder}:{ros_master.env['PYTHONPATH']}"


@pytest.fixture(scope="module")
def lab(ros_master: RosMaster, message_path: str) -> Iterator[None]:
    """The lab's ROS programs."""
    command = [sys.executable, "-m", "tests.integration.rosbridge.lab_side"]
    program = Program(command, {**ros_master.env, "PYTHONPATH": message_path})
    program.wait_for("ready")
    yield
    program.stop()


@pytest.fixture(scope="module")
def port(start_rosbridge: Callable[..., Rosbridge], message_path: str, lab: None) -> str:
    """Of the open rosbridge."""
    return str(start_rosbridge(LASERBOT_ROSBRIDGE_OPEN="1", PYTHONPATH=message_path).port)


@pytest.fixture(scope="module")
def rosout(ros_master: RosMaster) -> Iterator[None]:
    """As every ROS has it."""
    program = Program.python("server.ros.rosout", env=ros_master.env)
    master = Master(ros_master.uri, "test")
    until(lambda: ["/rosout", ["/rosout"]] in master.call("getSystemState")[1], 20, "rosout is registered")
    yield
    program.stop()


def without_failure(told: dict[str, Any]) -> dict[str, Any]:
    """The service's own words must be the end of what the library says of its failure."""
    assert told.pop("failure").endswith("not today")
    return told


@pytest.mark.parametrize("library", ["roslib", "roslib1"])
def test_roslib_does_all_that_it_can(port: str, library: str) -> None:
    told = told_by(Program([str(NODE), str(HERE / "roslib_lab.mjs"), library, port]))
    assert without_failure(told) == {**TOLD, "png": NUMBERS, "cbor": NUMBERS}


@pytest.mark.slow
@pytest.mark.parametrize("library", ["@foxglove/roslibjs", "@lichtblick/roslibjs"])
def test_forks_of_roslib_do_the_same(port: str, library: str) -> None:
    """They have no client for tf."""
    told = told_by(Program([str(NODE), str(HERE / "roslib_lab.mjs"), library, port]))
    without_tf = {name: value for name, value in TOLD.items() if name != "tf"}
    assert without_failure(told) == {**without_tf, "png": NUMBERS, "cbor": NUMBERS}


@pytest.mark.parametrize("transport", ["twisted", "asyncio"])
def test_roslibpy_does_all_that_it_can(port: str, transport: str) -> None:
    command = [sys.executable, "-m", "tests.integration.rosbridge.roslibpy_lab", port]
    assert without_failure(told_by(Program(command, {"ROSLIBPY_TRANSPORT": transport}))) == TOLD


@pytest.mark.slow
@pytest.mark.parametrize("transport", ["twisted", "asyncio"])
def test_roslibpys_own_suite_passes(port: str, rosout: None, transport: str, tmp_path: Path) -> None:
    """Its tests with a ROS 1, from its source distribution (requirements/suites.txt); they name upstream's port."""
    (suite,) = (ROOT / "build" / "suites").glob("roslibpy-*/tests")
    for path in [suite / "conftest.py", *(suite / "ros1").glob("*.py")]:
        (tmp_path / path.name).write_text(path.read_text().replace("9090", port))
    command = [sys.executable, "-m", "pytest", "-c", "/dev/null", "--rootdir", str(tmp_path), str(tmp_path), "-q"]
    program = Program([*command, "-p", "no:cacheprovider"], {"ROSLIBPY_TRANSPORT": transport})
    try:
        assert program.exit_code(200) == 0, program.output
    finally:
        program.kill()
    assert re.search(r"^2\d passed in", program.output, re.MULTILINE), "none was left out"


@pytest.mark.slow
def test_ros_tools_call_the_services_of_rosapi(port: str, ros_master: RosMaster) -> None:
    command = ["rosservice", "call", "/rosapi/topic_type", "/lab/say"]
    called = subprocess.run(command, env={**os.environ, **ros_master.env}, capture_output=True, text=True, check=False)
    assert (called.stdout, called.returncode) == ('type: "std_msgs/String"\n', 0), called.stderr


@pytest.mark.slow
@pytest.mark.parametrize("client", CLIENTS, ids=lambda client: client.name)
def test_requests_of_other_clients_are_understood(port: str, client: Client) -> None:
    speaker = Speaker(client, int(port))
    with speaker.socket:
        speaker.say("subscribe", topic="/lab/echo", type="std_msgs/String")
        speaker.say("advertise", topic="/lab/say", type="std_msgs/String")
        for text in (client.name, "end"):
            speaker.say("publish", topic="/lab/say", msg={"data": text})
        while client.name not in speaker.hear("publish")["msg"]["data"]:  # what a client before has said
            pass
        speaker.say("unsubscribe", topic="/lab/echo")
        speaker.say("unadvertise", topic="/lab/say")
        asked = speaker.say("call_service", service="/lab/set_bool", args={"data": True}, id="call 1")
        answer = speaker.hear("service_response")
        assert (answer["id"], answer["result"], answer["values"]["success"]) == (asked, True, True)
        speaker.say("advertise_service", service="/client/set_bool", type="std_srvs/SetBool")
        speaker.say("call_service", service="/lab/ask", args={}, id="call 2")
        call = speaker.hear("call_service")
        values = {"success": call["args"]["data"], "message": client.name}
        speaker.say("service_response", id=call["id"], service=call["service"], values=values, result=True)
        assert speaker.hear("service_response")["values"] == values
        speaker.say("unadvertise_service", service="/client/set_bool")
