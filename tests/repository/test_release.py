"""`ci/release`: the files of a release, and when it refuses."""

import hashlib
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.support.programs import ROOT

IMAGES = (
    "webserver-linux_amd64",
    "webserver-linux_arm64",
    "rosberry-linux_arm_v7",
    "sim-linux_amd64",
    "monitoring-linux_amd64",
)


@pytest.fixture
def built(tmp_path: Path) -> Path:
    """A copy of what ci/release reads, as after `ci/setup test` and `ci/images`; version 2.3.4."""
    (tmp_path / "ci").mkdir()
    shutil.copy(ROOT / "ci/release", tmp_path / "ci")
    (tmp_path / "laser_bot_battle").mkdir()
    (tmp_path / "laser_bot_battle/package.xml").write_text("<package>\n  <version>2.3.4</version>\n</package>\n")
    (tmp_path / "CHANGELOG.md").write_text(
        "# Changelog\n\n## [2.3.4] - 2026-01-02\n\n- New.\n\n## [2.3.3] - 2026-01-01\n\n- Old.\n"
    )
    (tmp_path / "build/firmware").mkdir(parents=True)
    (tmp_path / "build/firmware/laserbot.hex").write_text(":00000001FF\n")
    (tmp_path / "build/sbom").mkdir()
    for image in IMAGES:
        (tmp_path / f"build/sbom/{image}.cdx.json").write_text(image)
    return tmp_path


def release(folder: Path, tag: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([folder / "ci/release", tag], capture_output=True, text=True, check=False)


def test_a_release_is_firmware_lists_of_contents_notes_and_checksums(built: Path) -> None:
    (built / "build/release").mkdir()
    (built / "build/release/of-an-earlier-version.hex").touch()
    result = release(built, "v2.3.4")
    assert result.returncode == 0, result.stderr
    files = {path.name: path for path in (built / "build/release").iterdir()}
    checked = {"laserbot-2.3.4.hex", *(f"{image}-2.3.4.cdx.json" for image in IMAGES)}
    assert set(files) == checked | {"SHA256SUMS.txt", "notes.md"}
    lines = [line.split("  ") for line in files["SHA256SUMS.txt"].read_text().splitlines()]
    sums = {name: digest for digest, name in lines}
    assert sums == {name: hashlib.sha256(files[name].read_bytes()).hexdigest() for name in checked}
    assert files["notes.md"].read_text().split() == ["-", "New."]


@pytest.mark.parametrize(
    ("version", "released", "tags"),
    [
        ("2.3.4", "2.3.4 2.3.3 2.2.10 2.3.4-rc1", "2.3.4 2.3 latest"),
        ("2.3.10", "2.3.10 2.3.9 2.4.0-rc1", "2.3.10 2.3 latest"),
        ("2.3.4", "2.3.4 2.31.0", "2.3.4 2.3"),
        ("2.3.4", "2.3.4 2.3.5", "2.3.4"),
        ("2.3.4-rc1", "2.3.4-rc1 2.3.3", "2.3.4-rc1"),
    ],
)
def test_the_highest_images_of_a_series_have_its_tag_and_the_highest_of_all_are_the_latest(
    built: Path, version: str, released: str, tags: str
) -> None:
    (built / "laser_bot_battle/package.xml").write_text(f"<package>\n  <version>{version}</version>\n</package>\n")

    def run(*words: str) -> str:
        return subprocess.run(words, cwd=built, capture_output=True, text=True, check=True).stdout

    run("git", "init", "--quiet")
    run("git", "-c", "user.name=x", "-c", "user.email=x", "commit", "--quiet", "--allow-empty", "--message", "x")
    for tagged in released.split():
        run("git", "tag", f"v{tagged}")
    assert run("ci/release", "--tags", f"v{version}").split() == tags.split()
    assert not (built / "build/release").exists()


@pytest.mark.parametrize(
    ("tag", "missing", "complaint"),
    [
        ("v2.3.5", None, "the tag v2.3.5 does not fit version 2.3.4"),
        ("2.3.4", None, "the tag 2.3.4 does not fit"),
        ("v2.3.4", "build/firmware/laserbot.hex", "ci/setup test"),
        ("v2.3.4", "build/sbom/rosberry-linux_arm_v7.cdx.json", "nothing about rosberry: ci/images"),
    ],
)
def test_what_does_not_fit_or_is_missing_is_told(built: Path, tag: str, missing: str | None, complaint: str) -> None:
    if missing:
        (built / missing).unlink()
    result = release(built, tag)
    assert result.returncode == 1
    assert complaint in result.stderr
    assert not (built / "build/release").exists()


def test_a_version_without_notes_is_refused(built: Path) -> None:
    (built / "CHANGELOG.md").write_text("# Changelog\n\n## [2.3.40] - 2026-01-02\n\n- Another.\n")
    result = release(built, "v2.3.4")
    assert result.returncode == 1
    assert "CHANGELOG.md says nothing of version 2.3.4" in result.stderr


def test_a_version_without_a_date_is_refused(built: Path) -> None:
    (built / "CHANGELOG.md").write_text("# Changelog\n\n## [2.3.4] - Unreleased\n\n- New.\n")
    result = release(built, "v2.3.4")
    assert result.returncode == 1
    assert "the heading [2.3.4] of CHANGELOG.md has no date" in result.stderr


def test_this_version_has_notes() -> None:
    version = (ROOT / "laser_bot_battle/package.xml").read_text().split("<version>")[1].split("<")[0]
    assert f"\n## [{version}] - " in (ROOT / "CHANGELOG.md").read_text()
