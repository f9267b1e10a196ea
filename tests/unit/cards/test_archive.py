"""The file that brings another version: what is wrong with one is told, and nothing but a whole one is used."""

import hashlib
import io
import json
import os
import subprocess
import tarfile
from pathlib import Path
from typing import Any

import pytest

from cards.archive import manifest_of, unpack
from tests.support.programs import ROOT
from tests.support.updates import IMAGES, part, write_update

IMAGE = "robot/image.tar"
DESCRIPTION = "robot/containers/robot.json"


@pytest.fixture
def update(tmp_path: Path) -> Path:
    write_update(tmp_path / "laserbot-2.update", "2")
    return tmp_path / "laserbot-2.update"


def members(path: Path) -> dict[str, bytes]:
    with tarfile.open(path) as tar:
        return {member.name: tar.extractfile(member).read() for member in tar}  # type: ignore[union-attr]


def rewrite(path: Path, files: dict[str, bytes], /, **manifest: Any) -> None:
    """The archive anew with these files, whose sums its manifest has, and with other words in that."""
    document = json.loads(files.pop("manifest.json"))
    sums = {name: {"size": len(one), "sha256": hashlib.sha256(one).hexdigest()} for name, one in files.items()}
    document = {**document, "files": sums, **manifest}
    with tarfile.open(path, "w") as tar:
        for name, content in {"manifest.json": json.dumps(document).encode(), **files}.items():
            entry = tarfile.TarInfo(name)
            entry.size = len(content)
            tar.addfile(entry, io.BytesIO(content))


def refused(path: Path, folder: Path) -> str:
    with pytest.raises(ValueError) as caught:
        unpack(path, manifest_of(path), folder)
    return str(caught.value)


def test_a_whole_one_is_what_it_was_made_from(update: Path, tmp_path: Path) -> None:
    manifest = manifest_of(update)
    assert manifest.version == "2"
    unpack(update, manifest, tmp_path / "unpacked")
    for role in IMAGES:
        part(tmp_path / "expected" / role, role, "2")
    found = {path.relative_to(tmp_path / "unpacked"): path for path in (tmp_path / "unpacked").rglob("*.*")}
    assert {path.relative_to(tmp_path / "expected") for path in (tmp_path / "expected").rglob("*.*")} == found.keys()
    assert all(path.read_bytes() == (tmp_path / "expected" / name).read_bytes() for name, path in found.items())


@pytest.mark.parametrize("content", [b"", b"\0" * 20480, b"PK\3\4", b"[[" * 99999, b"hall"])
def test_another_file_is_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.update").write_bytes(content)
    assert "is no update of LaserBot Battle" in refused(tmp_path / "a.update", tmp_path / "unpacked")


def test_a_foreign_archive_is_refused(tmp_path: Path) -> None:
    with tarfile.open(tmp_path / "a.update", "w") as tar:
        tar.add(__file__, "test.py")
    assert refused(tmp_path / "a.update", tmp_path / "unpacked").startswith("is no update of LaserBot Battle")


@pytest.mark.parametrize("cut", ["half", "zeros", "one byte"])
def test_a_half_copied_one_is_refused(cut: str, update: Path, tmp_path: Path) -> None:
    """Wherever it ends: between two files, within one, or only where the copying program had no time for the end."""
    content = update.read_bytes()
    with tarfile.open(update) as tar:
        ends = [member.offset_data + member.size for member in tar]
    for end in ends[:-1] if cut != "one byte" else ends[-1:]:
        kept = content[: end + (-1 if cut == "one byte" else 100)]
        update.write_bytes(kept if cut != "zeros" else kept + b"\0" * (len(content) - len(kept)))
        refused(update, tmp_path / str(end))


@pytest.mark.parametrize(
    "words, told",
    [
        ({"format": 2}, "is of another kind (2) than this card knows (1): write the card itself anew"),
        ({"version": "../etc"}, "has no version that could be one"),
        ({"version": ""}, "has no version that could be one"),
        ({"version": 2}, "has no version that could be one"),
        ({"version": ".new"}, "has no version that could be one"),
        ({"files": {}}, "lacks what a robot's card needs"),
        ({"files": []}, "is no update of LaserBot Battle"),
        ({"files": {"../x": {"size": 1, "sha256": "0" * 64}}}, "lists files that no card needs"),
        ({"files": {IMAGE: {"size": -1, "sha256": "0" * 64}}}, "lists files that no card needs"),
        ({"files": {IMAGE: {"size": 1 << 60, "sha256": "0" * 64}}}, "lists files that no card needs"),
        ({"files": {IMAGE: {"size": 1, "sha256": "0"}}}, "lists files that no card needs"),
        ({"files": {IMAGE: {"size": 1}}}, "is no update of LaserBot Battle"),
    ],
)
def test_a_manifest_that_is_none_is_told(words: dict[str, Any], told: str, update: Path, tmp_path: Path) -> None:
    rewrite(update, members(update), **words)
    assert told in refused(update, tmp_path / "unpacked")


@pytest.mark.parametrize(
    "name, content, told",
    [
        (DESCRIPTION, b"[]", "is broken: robot.json describes no container"),
        (DESCRIPTION, b'{"Image": "x"}', "is broken: robot.json describes no container"),
        (DESCRIPTION, b"{", "is broken: robot.json describes no container"),
        (DESCRIPTION, b'{"Image": "x", "Env": [1]}', "is broken: robot.json describes no container"),
        (DESCRIPTION, b'{"Image": "x", "Env": ["A"]}', "is broken: robot.json describes no container"),
        (DESCRIPTION, b'{"Image": "x", "Env": {"A": "B"}}', "is broken: robot.json describes no container"),
        (DESCRIPTION, b'{"Image": ["x"], "Env": []}', "is broken: robot.json describes no container"),
        (DESCRIPTION, b'{"Image": "x y", "Env": []}', "is broken: robot.json describes no container"),
        (DESCRIPTION, None, f"lacks {DESCRIPTION}"),
        (IMAGE, None, f"lacks {IMAGE}"),
    ],
)
def test_one_with_other_files_is_refused(
    name: str, content: bytes | None, told: str, update: Path, tmp_path: Path
) -> None:
    files = members(update)
    files.pop(name)
    rewrite(update, {**files, name: content} if content is not None else files)
    assert refused(update, tmp_path / "unpacked") == told


def test_each_changed_byte_of_a_file_is_found(update: Path, tmp_path: Path) -> None:
    content = bytearray(update.read_bytes())
    with tarfile.open(update) as tar:
        places = {member.name: member.offset_data for member in tar if member.name != "manifest.json"}
    for name, place in places.items():
        content[place] ^= 1
        update.write_bytes(content)
        content[place] ^= 1
        told = f"is broken: {'/'.join(name.split('/')[-2:])} is not what it should be"
        assert refused(update, tmp_path / name.replace("/", "-")) == told


@pytest.mark.parametrize("kind", [tarfile.REGTYPE, tarfile.SYMTYPE, tarfile.DIRTYPE])
@pytest.mark.parametrize("name", ["../../etc/passwd", "/etc/passwd", IMAGE])
def test_nothing_is_written_that_the_manifest_does_not_name(
    name: str, kind: bytes, update: Path, tmp_path: Path
) -> None:
    entry = tarfile.TarInfo(name)
    entry.type, entry.linkname = kind, "/etc"
    with tarfile.open(update, "a") as tar:
        tar.addfile(entry)
    assert refused(update, tmp_path / "unpacked").startswith("holds more than it should")
    assert {path.name for path in tmp_path.iterdir()} == {update.name, "unpacked"}


@pytest.mark.parametrize("kind", [tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.DIRTYPE, tarfile.CHRTYPE, tarfile.FIFOTYPE])
@pytest.mark.parametrize("name", [IMAGE, DESCRIPTION, "manifest.json"])
def test_nothing_but_a_file_is_taken_for_one(name: str, kind: bytes, update: Path, tmp_path: Path) -> None:
    with tarfile.open(update) as old, tarfile.open(tmp_path / "a.update", "w") as new:
        for member in old:
            content = old.extractfile(member)
            if member.name == name:
                member.type, member.linkname, member.size = kind, "nowhere", 0
            new.addfile(member, content)
    told = "is no update" if name == "manifest.json" else f"holds a link, a folder or a device as {name}"
    assert refused(tmp_path / "a.update", tmp_path / "unpacked").startswith(told)


def test_a_size_that_is_none_is_refused(update: Path, tmp_path: Path) -> None:
    with tarfile.open(update) as old, (tmp_path / "a.update").open("wb") as new:
        _, second, *_ = old
        second.type, second.size = tarfile.XHDTYPE, 1 << 80  # of more words about the next file
        new.write(update.read_bytes()[: second.offset])
        new.write(second.tobuf(tarfile.GNU_FORMAT) + bytes(10240))
    assert refused(tmp_path / "a.update", tmp_path / "unpacked") == "ends too early: copy it again"


def test_the_program_writes_the_same_bytes_each_time(update: Path, tmp_path: Path) -> None:
    for role in IMAGES:
        part(tmp_path / "folder" / role, role, "2")
    environ = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT}/laser_bot_battle/src"}
    command = ["/usr/bin/python3", "-m", "cards.archive", "2", f"{tmp_path}/folder", f"{tmp_path}/again.update"]
    subprocess.run(command, cwd=ROOT, env=environ, check=True)
    assert (tmp_path / "again.update").read_bytes() == update.read_bytes()
