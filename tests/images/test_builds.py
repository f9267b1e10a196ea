"""The same sources give the same images, wherever, whenever and with whatever they are built."""

import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from docker.errors import APIError, ImageNotFound

from tests.images.conftest import build
from tests.support.containers import engine, run
from tests.support.imagefile import IMAGES, platforms
from tests.support.programs import ROOT

pytestmark = pytest.mark.slow


def image_id(name: str) -> str:
    return str(engine().images.get(name).id)


def forget(tag: str) -> None:
    for image in IMAGES:
        engine().images.remove(f"{image}:{tag}")


def test_the_same_sources_give_the_same_images(version: str, figures: list[str]) -> None:
    def digests() -> list[str]:
        return [image_id(f"{name}:{version}") for name in IMAGES]

    before = digests()
    took = build(NO_CACHE="1", LOCKED="1")
    figures.append(f"cold build of all images for all platforms: {took:.0f} s (webserver and rosberry: budget 300 s)")
    assert digests() == before


def build_with(command: list[str], sources: Path, **variables: str) -> float:
    """Build all images of the sources in another folder; s that it took."""
    began = time.monotonic()
    result = subprocess.run(
        command, env={**os.environ, **variables}, cwd=sources, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    return time.monotonic() - began


def tags(tag: str) -> list[str]:
    return [f"--set={image}.tags={image}:{tag}" for image in IMAGES]


def bake(sources: Path, tag: str, **variables: str) -> float:
    """As ci/images does, from what it has prepared, under another tag."""
    command = [str(ROOT / "ci/bake"), "--progress=plain", f"--set=*.context={sources}", *tags(tag)]
    return build_with(command, ROOT, **variables)


def said_of_sources(version: str) -> dict[str, str]:
    """What an image says of the sources, as variables of a build."""
    labels = engine().images.get(f"webserver:{version}").labels
    said = {name: labels[f"org.opencontainers.image.{name.lower()}"] for name in ("VERSION", "REVISION", "SOURCE")}
    return {**said, "SOURCE_DATE_EPOCH": run(f"webserver:{version}", "linux/amd64", "cat", "date").strip()}


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """The sources as somebody else has them: of today, and closed to others (umask 077)."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    bundle = (path for path in (ROOT / "server/static/bundle").rglob("*") if path.is_file())
    for source in [*(ROOT / name for name in listed.splitlines()), *bundle]:
        target = tmp_path / source.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        shutil.copyfile(source, target)
        target.chmod(source.stat().st_mode & 0o700)
    return tmp_path


def test_another_checkout_of_the_same_sources_gives_the_same_images(version: str, checkout: Path) -> None:
    bake(checkout, "copy", **said_of_sources(version))
    for image in IMAGES:
        assert image_id(f"{image}:{version}") == image_id(f"{image}:copy"), image
    forget("copy")


@pytest.fixture
def debian(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Debian's own image. Where no registry can be reached, ours stands for it, with this machine's certificates."""
    images, name = engine().images, "debian:trixie-slim"
    try:
        images.get(name)
    except ImageNotFound:
        try:
            images.pull(name)
        except APIError:
            folder, certificates = tmp_path_factory.mktemp("debian"), "usr/local/share/ca-certificates"
            (folder / "own").mkdir()
            for file in Path("/", certificates).glob("*.crt"):
                shutil.copy(file, folder / "own")
            (folder / "Dockerfile").write_text(f"FROM localhost/laserbot/base:trixie\nCOPY own /{certificates}\n")
            subprocess.run(["docker", "build", "--quiet", f"--tag={name}", folder], check=True, capture_output=True)
            yield
            images.remove(name)
            return
    yield


@pytest.mark.usefixtures("debian")
def test_docker_alone_gives_the_same_images(version: str, figures: list[str], checkout: Path) -> None:
    shutil.rmtree(checkout / "server/static/bundle")
    command = ["docker", "buildx", "bake", "--progress=plain", *tags("alone")]
    took = build_with(command, checkout, LOCKED="1", **said_of_sources(version))
    figures.append(f"build of all images for all platforms with Docker alone: {took:.0f} s, with what the cache had")
    for image in IMAGES:
        assert image_id(f"{image}:{version}") == image_id(f"{image}:alone"), image
    forget("alone")
    for profiles in (["demo"], ["master", "robot", "camera", "monitoring"]):
        compose = ["docker", "compose", *(f"--profile={profile}" for profile in profiles), "build"]
        build_with(compose, checkout, LASERBOT_VERSION="composed")
    forget("composed")


def test_the_date_of_the_files_is_that_of_this_build_whatever_was_built_before(version: str, checkout: Path) -> None:
    """It is part of the digest, and of what a browser compares when it asks for a file again."""
    bake(checkout, "dated", VERSION=version, SOURCE_DATE_EPOCH="1700000000")
    assert run("webserver:dated", "linux/amd64", "stat", "-c", "%Y", "server/web/app.py").strip() == "1700000000"
    forget("dated")


def test_one_changed_file_is_in_all_platforms_of_the_next_build(
    version: str, figures: list[str], checkout: Path
) -> None:
    bake(checkout, "changed", VERSION=version)
    with (checkout / "server/web/app.py").open("a") as file:
        file.write("# changed\n")
    took = bake(checkout, "changed", VERSION=version)
    figures.append(f"build after one changed file: {took:.1f} s (budget 20 s)")
    for platform in platforms("webserver"):
        assert "# changed" in run("webserver:changed", platform, "tail", "-n", "1", "server/web/app.py")
    forget("changed")
