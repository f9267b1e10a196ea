"""What is inside the images: true lists of packages, nothing that changes from build to build."""

import json
import os
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from tests.images.conftest import build
from tests.support.containers import docker, run
from tests.support.programs import ROOT

PLATFORMS = {
    "webserver": ["linux/amd64", "linux/arm64"],
    "rosberry": ["linux/amd64", "linux/arm64", "linux/arm/v7"],
    "sim": ["linux/amd64", "linux/arm64", "linux/arm/v7"],
}
EVERY = [(image, platform) for image, platforms in PLATFORMS.items() for platform in platforms]
DEBIAN = {"linux/amd64": "amd64", "linux/arm64": "arm64", "linux/arm/v7": "armhf"}


def locked(image: str, platform: str) -> set[str]:
    """The names of the packages in the lock."""
    lines = [line.split() for line in (ROOT / f"images/{image}.lock").read_text().splitlines()]
    return {
        path.rpartition("/")[2].partition("_")[0]
        for architecture, path, *_ in lines
        if architecture == DEBIAN[platform]
    }


@pytest.mark.parametrize(("image", "platform"), EVERY)
def test_dpkg_knows_exactly_the_locked_packages(version: str, image: str, platform: str) -> None:
    listed = run(f"{image}:{version}", platform, "dpkg-query", "-W", "-f", "${Status} ${Package}\n").splitlines()
    assert {line.removeprefix("install ok installed ") for line in listed} == locked(image, platform)


@pytest.mark.parametrize(("image", "platform"), EVERY)
def test_every_file_of_the_packages_is_there_but_for_what_is_left_out(version: str, image: str, platform: str) -> None:
    left_out = [
        line.removeprefix(".").replace("*", "")
        for line in (ROOT / "images/left-out.txt").read_text().splitlines()
        if line and not line.startswith("#")
    ]
    # dpkg's own check: a line for each file that is missing or has other contents
    script = "dpkg --verify 2>&1; true"
    for line in run(f"{image}:{version}", platform, "sh", "-c", script).splitlines():
        path = line[line.index("/") :]
        assert any(all(part in path for part in pattern.split("//")) for pattern in left_out), line


@pytest.mark.parametrize(("image", "platform"), EVERY)
def test_each_image_has_a_list_of_its_contents(version: str, image: str, platform: str) -> None:
    document = json.loads((ROOT / f"build/sbom/{image}-{platform.replace('/', '_')}.cdx.json").read_text())
    names = {component["name"] for component in document["components"]}
    assert locked(image, platform) <= names
    assert ("roslib" in names) == (image == "webserver"), "the page's bundle"


@pytest.mark.parametrize(("image", "platform"), EVERY)
def test_the_root_cannot_be_written_and_byte_code_is_there(version: str, image: str, platform: str) -> None:
    # with -v, Python names the file of each module's code: a cached one or, if there is none, the source
    count = "python3 -v -c 'import logging, xmlrpc.client' 2>&1 | grep -c 'code object from.*[.]py.$'"
    script = f"id -u; touch /opt/x 2>/dev/null || echo read-only; {count}; true"
    assert run(f"{image}:{version}", platform, "sh", "-c", script).split() == ["10001", "read-only", "0"]


@pytest.mark.parametrize("image", PLATFORMS)
def test_the_image_says_what_it_is_and_how_it_runs(version: str, image: str) -> None:
    config = json.loads(docker("image", "inspect", "--format", "{{json .Config}}", f"{image}:{version}"))
    assert config["User"] == "10001:10001"
    assert config["StopSignal"] == "SIGINT"
    assert config["Healthcheck"]["Test"] == ["CMD", "python3", "-m", "images.health"]
    assert config["Cmd"][:2] == ["python3", "-m"]
    assert not config.get("Entrypoint")
    labels = {name.removeprefix("org.opencontainers.image."): text for name, text in config["Labels"].items()}
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert labels["version"] == version
    assert labels["revision"].removesuffix("-dirty") == head.strip()
    assert "source" in labels
    assert labels["title"].startswith("LaserBot Battle")


def test_the_same_sources_give_the_same_images(version: str, figures: list[str]) -> None:
    def digests() -> str:
        names = [f"{name}:{version}" for name in PLATFORMS]
        return docker("image", "inspect", "--format", "{{.RepoTags}} {{.Id}}", *names)

    before = digests()
    took = build(NO_CACHE="1")
    figures.append(f"cold build of all images for all platforms: {took:.0f} s (webserver and rosberry: budget 300 s)")
    assert digests() == before


def bake(sources: Path, tag: str, **variables: str) -> float:
    """Build all images of the sources in another folder, under another tag; s that it took."""
    tags = [f"--set={image}.tags={image}:{tag}" for image in PLATFORMS]
    began = time.monotonic()
    result = subprocess.run(
        [ROOT / "ci/bake", "--progress=plain", f"--set=*.context={sources}", *tags],
        env={**os.environ, **variables}, cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    return time.monotonic() - began


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """The sources as somebody else has them: of today, and closed to others (umask 077)."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in [*listed.splitlines(), *map(str, (ROOT / "server/static/bundle").glob("*.js*"))]:
        source = ROOT / name
        target = tmp_path / source.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        shutil.copyfile(source, target)
        target.chmod(source.stat().st_mode & 0o700)
    return tmp_path


def test_another_checkout_of_the_same_sources_gives_the_same_images(version: str, checkout: Path) -> None:
    labels = json.loads(docker("image", "inspect", "--format", "{{json .Config.Labels}}", f"webserver:{version}"))
    said = {name: labels[f"org.opencontainers.image.{name.lower()}"] for name in ("VERSION", "REVISION", "SOURCE")}
    date = run(f"webserver:{version}", "linux/amd64", "cat", "date").strip()
    bake(checkout, "copy", SOURCE_DATE_EPOCH=date, **said)
    for image in PLATFORMS:
        ids = docker("image", "inspect", "--format", "{{.Id}}", f"{image}:{version}", f"{image}:copy").split()
        assert ids[0] == ids[1], image
    docker("image", "rm", *(f"{image}:copy" for image in PLATFORMS))


def test_the_date_of_the_files_is_that_of_this_build_whatever_was_built_before(version: str, checkout: Path) -> None:
    """It is part of the digest, and of what a browser compares when it asks for a file again."""
    bake(checkout, "dated", VERSION=version, SOURCE_DATE_EPOCH="1700000000")
    assert run("webserver:dated", "linux/amd64", "stat", "-c", "%Y", "server/web/app.py").strip() == "1700000000"
    docker("image", "rm", *(f"{image}:dated" for image in PLATFORMS))


def test_one_changed_file_is_in_all_platforms_of_the_next_build(
    version: str, figures: list[str], checkout: Path
) -> None:
    bake(checkout, "changed", VERSION=version)
    with (checkout / "server/web/app.py").open("a") as file:
        file.write("# changed\n")
    took = bake(checkout, "changed", VERSION=version)
    figures.append(f"build after one changed file: {took:.1f} s (budget 20 s)")
    for platform in PLATFORMS["webserver"]:
        assert "# changed" in run("webserver:changed", platform, "tail", "-n", "1", "server/web/app.py")
    docker("image", "rm", *(f"{image}:changed" for image in PLATFORMS))
