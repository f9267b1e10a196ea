"""Every image for every platform, in one container each: it starts, and what is inside is what the lists say."""

import json
import subprocess
from collections.abc import Iterator
from typing import NamedTuple

import pytest

from tests.images.conftest import EVERY, NATIVE
from tests.support.containers import Container, engine
from tests.support.imagefile import IMAGES, dockerfile
from tests.support.polling import until
from tests.support.programs import ROOT

DEBIAN = {"linux/amd64": "amd64", "linux/arm64": "arm64", "linux/arm/v7": "armhf"}
OTHER_PROGRAMS = {
    "webserver": [
        "python3 -m server.ros.master --help",
        "python3 -m server.rosbridge --help",
        "python3 -m server.camera --help",
        "python3 -m server.ros.rosout --help",
        "python3 -m server.announcer --help",
        "python3 -m server.overhead --help",
        "python3 -c 'from server.overhead.eye import Looker; print(Looker())'",
        "python3 -m server.bots --help",
        "python3 -m server.entrance --help",
    ],
    "rosberry": [
        "python3 -m robot.serial_node --help",
        "python3 -m robot.find --help",
        "python3 -m robot.camera --help",
        "ustreamer --version",
        "LD_PRELOAD=$(echo /usr/libexec/*/libcamera/v4l2-compat.so) ustreamer --version",
        "python3 -c 'from robot.camera.settings import find_libcamera; print(find_libcamera().stat())'",
        "avrdude -c '?' -p m328p 2>&1 | grep -w arduino",
    ],
    "sim": ["avr_robot --help", "python3 -m sim.positions --help"],
    "monitoring": ["prometheus-alertmanager --version 2>&1", "amtool --version 2>&1"],
}


on_every_platform = pytest.mark.parametrize("started", EVERY, indirect=True, scope="module")
# what is inside does not depend on who runs it, and looking takes long in an emulator
natively = pytest.mark.parametrize("started", NATIVE, indirect=True, scope="module")


class Started(NamedTuple):
    """An image's own program, running for this platform."""

    image: str
    platform: str
    container: Container

    def sh(self, script: str) -> str:
        return self.container.run("sh", "-c", script)


@pytest.fixture(scope="module")
def ros_master(version: str, network: str) -> Iterator[str]:
    """The URI of one that runs natively."""
    words = ["python3", "-m", "server.ros.master", "-p", "11311"]
    with Container(f"webserver:{version}", "linux/amd64", *words, network=network, name="master"):
        yield "http://master:11311"


@pytest.fixture(scope="module")
def started(request: pytest.FixtureRequest, version: str, network: str, ros_master: str) -> Iterator[Started]:
    image, platform = request.param
    environment = {"ROS_MASTER_URI": ros_master, "LASERBOT_SERIAL": "/nowhere"}
    data = ["/var/lib/laserbot"]  # without which Prometheus does not begin
    with Container(
        f"{image}:{version}", platform, network=network, name="program", env=environment, volumes=data
    ) as container:
        yield Started(image, platform, container)


def locked(image: str, platform: str) -> set[str]:
    """The names of the packages in the lock."""
    lines = [line.split() for line in (ROOT / f"images/{image}.lock").read_text().splitlines()]
    return {line[1].rpartition("/")[2].partition("_")[0] for line in lines if line[0] == DEBIAN[platform]}


@on_every_platform
def test_its_program_works(started: Started, figures: list[str]) -> None:
    if started.image == "rosberry":  # as far as it can without an Arduino
        until(
            lambda: "No attached ARDUINO found: looked for /nowhere" in started.container.logs, 60, "it looks for one"
        )
        assert "no status LED: line 18 of /dev/gpiochip0: " in started.container.logs, "the GPIO's library is there"
    else:
        figures.append(
            f"{started.image} {started.platform}: healthy after {started.container.wait_until_healthy():.1f} s"
        )


@on_every_platform
def test_its_other_programs_start(started: Started) -> None:
    for script in OTHER_PROGRAMS[started.image]:
        assert started.sh(script)


@natively
def test_dpkg_knows_exactly_the_locked_packages(started: Started) -> None:
    listed = started.container.run("dpkg-query", "-W", "-f", "${Status} ${Package}\n").splitlines()
    names = {line.removeprefix("install ok installed ") for line in listed}
    assert names == locked(started.image, started.platform)


@natively
def test_every_file_of_the_packages_is_there_but_for_what_is_left_out(started: Started) -> None:
    left_out = [
        line.removeprefix(".").replace("*", "")
        for line in (ROOT / "images/left-out.txt").read_text().splitlines()
        if line and not line.startswith("#")
    ]
    # dpkg's own check: a line for each file that is missing or has other contents
    for line in started.sh("dpkg --verify 2>&1; true").splitlines():
        path = line[line.index("/") :]
        assert any(all(part in path for part in pattern.split("//")) for pattern in left_out), line


@natively
def test_the_root_cannot_be_written_and_byte_code_is_there(started: Started) -> None:
    # with -v, Python names the file of each module's code: a cached one or, if there is none, the source
    count = "python3 -v -c 'import logging, xmlrpc.client' 2>&1 | grep -c 'code object from.*[.]py.$'"
    if started.image == "monitoring":  # has no Python
        count = "command -v python3 | wc -l"
    script = f"id -u; touch /opt/x 2>/dev/null || echo read-only; {count}; true"
    assert started.sh(script).split() == ["10001", "read-only", "0"]


@natively
def test_our_parts_are_all_there(started: Started) -> None:
    parts = {"rosberry": ["laserbot.hex"], "sim": ["laserbot.elf"]}
    assert started.sh("ls /opt/laserbot/firmware 2>/dev/null; true").split() == parts.get(started.image, [])


@on_every_platform
def test_it_ends_when_told(started: Started) -> None:
    started.container.stop()


@pytest.mark.parametrize("built", EVERY)
def test_each_image_has_a_list_of_its_contents(version: str, built: tuple[str, str]) -> None:
    image, platform = built
    document = json.loads((ROOT / f"build/sbom/{image}-{platform.replace('/', '_')}.cdx.json").read_text())
    names = {component["name"] for component in document["components"]}
    assert locked(image, platform) <= names
    assert ("@fontsource-variable/oxanium" in names) == (image == "webserver"), "the page's bundle"


@pytest.mark.parametrize("image", IMAGES)
def test_the_image_says_what_it_is_and_how_it_runs(version: str, image: str) -> None:
    config = engine().images.get(f"{image}:{version}").attrs["Config"]
    assert config["StopSignal"] == "SIGINT"
    assert not config.get("Entrypoint")
    assert not config.get("Volumes")  # which would be left behind by every service that does not use it
    # what the manifests of k3s/ are checked against
    expected = dockerfile(image)
    assert config["User"] == expected.user
    assert config["Cmd"] == expected.command
    assert config["Healthcheck"]["Test"] == ["CMD", *expected.health]
    assert {int(port.split("/")[0]) for port in config.get("ExposedPorts") or {}} == expected.ports
    environment = dict(pair.split("=", 1) for pair in config["Env"])
    assert expected.environment.items() <= environment.items()
    assert "/usr/bin" in environment["PATH"]  # the manifests' commands name no folder
    labels = {name.removeprefix("org.opencontainers.image."): text for name, text in config["Labels"].items()}
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert labels["version"] == version
    assert labels["revision"].removesuffix("-dirty") == head.strip()
    assert "source" in labels
    assert labels["title"].startswith("LaserBot Battle")
