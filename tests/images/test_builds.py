"""The same sources give the same images, wherever and whenever they are built."""

import os
import shutil
import subprocess
import time
from pathlib import Path

import pytest

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
    took = build(NO_CACHE="1")
    figures.append(f"cold build of all images for all platforms: {took:.0f} s (webserver and rosberry: budget 300 s)")
    assert digests() == before


def bake(sources: Path, tag: str, **variables: str) -> float:
    """Build all images of the sources in another folder, under another tag; s that it took."""
    tags = [f"--set={image}.tags={image}:{tag}" for image in IMAGES]
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
    bundle = (path for path in (ROOT / "server/static/bundle").rglob("*") if path.is_file())
    for source in [*(ROOT / name for name in listed.splitlines()), *bundle]:
        target = tmp_path / source.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        shutil.copyfile(source, target)
        target.chmod(source.stat().st_mode & 0o700)
    return tmp_path


def test_another_checkout_of_the_same_sources_gives_the_same_images(version: str, checkout: Path) -> None:
    labels = engine().images.get(f"webserver:{version}").labels
    said = {name: labels[f"org.opencontainers.image.{name.lower()}"] for name in ("VERSION", "REVISION", "SOURCE")}
    date = run(f"webserver:{version}", "linux/amd64", "cat", "date").strip()
    bake(checkout, "copy", SOURCE_DATE_EPOCH=date, **said)
    for image in IMAGES:
        assert image_id(f"{image}:{version}") == image_id(f"{image}:copy"), image
    forget("copy")


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
