"""Images on their way: to a registry, and in an archive to a machine without a network."""

import json
import os
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import docker
import pytest
import requests
import yaml

from tests.images.conftest import Registry, build
from tests.support.containers import PATIENCE, engine
from tests.support.imagefile import IMAGES, platforms
from tests.support.programs import ROOT, Program

pytestmark = pytest.mark.slow

INDEX = "application/vnd.oci.image.index.v1+json, application/vnd.docker.distribution.manifest.list.v2+json"
MANIFEST = "application/vnd.oci.image.manifest.v1+json, application/vnd.docker.distribution.manifest.v2+json"
MACHINES = {"linux/amd64": "x86_64", "linux/arm64": "aarch64", "linux/arm/v7": "armv7l"}
BUDGET = {("rosberry", "linux/arm/v7"): 45.0}  # MB, compressed


def platform_name(platform: dict[str, str]) -> str:
    return "/".join(
        [platform["os"], platform["architecture"], *([platform["variant"]] if "variant" in platform else [])]
    )


def test_a_registry_gets_every_platform_under_one_name(version: str, registry: Registry, figures: list[str]) -> None:
    build(PUSH=registry.place)
    for image in IMAGES:
        api = f"http://{registry.place}/v2/{image}/manifests"
        answer = requests.get(f"{api}/{version}", headers={"Accept": INDEX}, timeout=10)
        assert answer.headers["Docker-Content-Digest"] == engine().images.get(f"{image}:{version}").id, (
            "what is pushed is what was built"
        )
        manifests = {platform_name(entry["platform"]): entry["digest"] for entry in answer.json()["manifests"]}
        assert sorted(manifests) == sorted(platforms(image))
        for platform, digest in manifests.items():
            manifest = requests.get(f"{api}/{digest}", headers={"Accept": MANIFEST}, timeout=10).json()
            size = sum(layer["size"] for layer in manifest["layers"]) / 1e6
            budget = BUDGET.get((image, platform))
            figures.append(f"{image} {platform}: {size:.1f} MB compressed{f' (budget {budget})' if budget else ''}")
            assert not budget or size <= budget
    local = [tag.rpartition(":")[0] for image in engine().images.list() for tag in image.tags]
    assert not [name for name in local if registry.place in name], "the engine keeps no second name"


def test_compose_takes_the_images_of_a_registry_and_builds_none(version: str, registry: Registry) -> None:
    """What it built would have another date, and so another digest."""
    build(PUSH=registry.place)
    compose = ["docker", "compose", "--project-name=laserbot-test-registry", "--profile=demo"]
    environment = {**os.environ, "LASERBOT_IMAGES": f"{registry.place}/", "LASERBOT_VERSION": version}
    try:
        made = subprocess.run(
            [*compose, "create"], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
        )
        assert made.returncode == 0, made.stderr
        for image in ("webserver", "rosberry", "sim"):
            pulled = engine().images.get(f"{registry.place}/{image}:{version}")
            assert pulled.id == engine().images.get(f"{image}:{version}").id
    finally:
        subprocess.run([*compose, "down", "--rmi=all", "--volumes"], cwd=ROOT, env=environment, check=False)


SCANNER = "docker/buildkit-syft-scanner:stable-1"
SCAN = """\
names=$(sed -n 's/^Package: //p' "$BUILDKIT_SCAN_SOURCE/var/lib/dpkg/status")
packages=$(for name in $names; do echo "{\\"name\\": \\"$name\\"}"; done | paste -sd ,)
echo "{\\"predicateType\\": \\"https://spdx.dev/Document\\", \\"predicate\\": {\\"packages\\": [$packages]}}" \
    >"$BUILDKIT_SCAN_DESTINATION/sbom.spdx.json"
"""


@pytest.fixture
def scanner(tmp_path: Path) -> Iterator[None]:
    """What lists an attested image's contents. If no registry has it, one for Debian's packages stands for it."""
    try:
        engine().images.pull(SCANNER)
        yield
    except docker.errors.APIError:
        (tmp_path / "scan").write_text(SCAN)
        (tmp_path / "Dockerfile").write_text('FROM localhost/laserbot/base:trixie\nCOPY scan /\nCMD ["sh", "/scan"]\n')
        subprocess.run(["docker", "build", "--quiet", f"--tag={SCANNER}", tmp_path], check=True, capture_output=True)
        yield
        engine().images.remove(SCANNER)


@pytest.mark.usefixtures("scanner")
def test_a_release_attests_how_it_was_built_and_what_is_inside(version: str, registry: Registry) -> None:
    def inspect(tag: str, what: str) -> Any:
        command = ["docker", "buildx", "imagetools", "inspect", f"{registry.place}/rosberry:{tag}"]
        done = subprocess.run([*command, f"--format={{{{json {what}}}}}"], capture_output=True, text=True, check=True)
        return json.loads(done.stdout)

    def layers(tag: str) -> dict[str, list[str]]:
        return {platform: image["rootfs"]["diff_ids"] for platform, image in inspect(tag, ".Image").items()}

    build("rosberry", PUSH=registry.place)
    plain = layers(version)
    try:
        build("rosberry", PUSH=registry.place, TAGS="2.3.4 2.3 latest", ATTEST="1")
    finally:
        build("rosberry")  # as the other tests expect it
    for tag in ("2.3.4", "2.3", "latest"):
        assert layers(tag) == plain
    for platform in platforms("rosberry"):
        assert inspect("latest", ".Provenance")[platform]["SLSA"]["buildType"]
        assert {"name": "python3-minimal"} in inspect("latest", ".SBOM")[platform]["SPDX"]["packages"]


@pytest.fixture
def folder() -> Iterator[Path]:
    """Where the first engine's store is: an engine cannot use every file system, such as that of a temporary folder."""
    with tempfile.TemporaryDirectory(dir=ROOT / "build", prefix="offline-") as name:
        yield Path(name)


class SecondEngine:
    """A second Docker Engine, empty. `store`: whether it has containerd's store (of several platforms).

    Its network is its own (else it would take away the first one's bridge), with nothing in it but, if there is one,
    a `mirror` of what is on Docker's own registry.
    """

    def __init__(self, folder: Path, store: bool, mirror: Registry | None = None) -> None:
        settings = {
            "features": {"containerd-snapshotter": store},
            "exec-opts": ["native.cgroupdriver=cgroupfs"],
            "cgroup-parent": "/laserbot-engine",
            "iptables": False,
            "bridge": "none",
            "registry-mirrors": [f"http://{mirror.place}"] if mirror else [],
        }
        (folder / "daemon.json").write_text(json.dumps(settings))
        # short: a socket's path has at most 107 characters
        self._run = tempfile.TemporaryDirectory(prefix="offline-", ignore_cleanup_errors=True)
        run = self._run.name
        self.host = f"unix://{run}/socket"
        words = ["--config-file", f"{folder}/daemon.json", "--data-root", f"{folder}/data"]
        words += ["--exec-root", f"{run}/exec", "--pidfile", f"{run}/pid", "--host", self.host]
        # its mounts, too, end with it
        self.program = Program(["unshare", "--mount", "--net", "dockerd", *words])
        self._mirror = mirror

    def load(self, archive: Path) -> None:
        with archive.open("rb") as file:
            self.client.images.load(file)

    def machine(self, image: str, platform: str | None = None) -> str:
        """What the image says of the machine that it runs on."""
        ask = ["uname", "-m"]
        return (
            self.client.containers.run(image, ask, remove=True, network_mode="none", platform=platform).decode().strip()
        )

    def __enter__(self) -> "SecondEngine":
        self.program.wait_for("API listen", 30)
        self.client = docker.DockerClient(self.host, timeout=PATIENCE)
        if self._mirror:
            inside = ["nsenter", f"--target={self.program.process.pid}", "--net"]
            subprocess.run([*inside, "ip", "link", "set", "lo", "up"], check=True)
            self._mirror_here = Program([*inside, *self._mirror.command])
        return self

    def __exit__(self, *_: object) -> None:
        self.client.close()
        if self._mirror:
            self._mirror_here.stop()
        self.program.stop(seconds=30)
        self._run.cleanup()


needs_own_engine = pytest.mark.skipif(
    os.environ.get("IMAGES_ENGINE") == "running", reason="a second engine is started beside a private one only"
)


@needs_own_engine
def test_an_archive_carries_every_platform(version: str, folder: Path) -> None:
    archive = folder / "laserbot.tar"
    build(ARCHIVE=str(archive))
    done = subprocess.run([ROOT / "k3s/images.py", "name", archive], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    named = {each["name"]: each["newTag"] for each in yaml.safe_load(done.stdout)["images"]}
    digests = {image: str(engine().images.get(f"{image}:{version}").id) for image in IMAGES}
    assert named == {image: f"{version}-{digest.replace(':', '-')}" for image, digest in digests.items()}
    with SecondEngine(folder, store=True) as second:
        second.load(archive)
        for image in IMAGES:
            for platform in platforms(image):
                assert second.machine(f"{image}:{version}", platform) == MACHINES[platform]


@needs_own_engine
def test_an_archive_for_one_platform_loads_on_an_engine_of_the_older_kind(version: str, folder: Path) -> None:
    archive = folder / "robot.tar"
    try:
        build("rosberry", PLATFORM="linux/arm/v7", ARCHIVE=str(archive))
    finally:
        build("rosberry")  # for all platforms again
    with SecondEngine(folder, store=False) as second:
        second.load(archive)
        assert second.machine(f"rosberry:{version}") == "armv7l"


@needs_own_engine
def test_the_base_is_pulled_where_a_registry_can_be_reached(version: str, registry: Registry, folder: Path) -> None:
    """The registry offers what the first engine has as base, under the name that Debian's own image has."""
    (own,) = engine().images.list("localhost/laserbot/base")
    (base,) = own.tags
    offered = f"{registry.place}/library/debian"
    own.tag(offered, "trixie-slim")
    for line in engine().images.push(offered, "trixie-slim", stream=True, decode=True):
        assert "error" not in line, line
    engine().images.remove(f"{offered}:trixie-slim")
    with SecondEngine(folder, store=True, mirror=registry) as second:
        environment = {**os.environ, "DOCKER_HOST": second.host}
        made = subprocess.run([ROOT / "ci/base"], env=environment, capture_output=True, text=True, check=False)
        assert (made.returncode, made.stdout.strip(), made.stderr) == (0, base, "")
        assert second.client.images.get(base).id == own.id
