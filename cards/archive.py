"""The file by which a card gets another version of the game.

    python3 -m cards.archive VERSION FOLDER FILE.update     writes one from FOLDER/robot and FOLDER/master

It is a plain tar: first manifest.json, which names the version and each other file with its size and SHA-256; then for
each role what its card holds, ROLE/image.tar (the image of its containers) and ROLE/containers/NAME.json (what the
engine needs to make them). A master serves the robots their part of it under the same names.
"""

import hashlib
import io
import json
import os
import re
import sys
import tarfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from cards.values import ROLES

FORMAT = 1
MANIFEST = "manifest.json"
LONGEST = 1 << 20  # bytes of a manifest, or of a container's description
_LARGEST = 1 << 32  # bytes of an image; a FAT partition holds no larger file
_CHUNK = 1 << 20  # bytes
_VERSION = re.compile(r"[0-9A-Za-z][0-9A-Za-z.+-]{0,63}")
_FILE = re.compile(r"(robot|master)/(image\.tar|containers/[a-z0-9-]{1,40}\.json)")
_SUM = re.compile(r"[0-9a-f]{64}")
_IMAGE = re.compile(r"[0-9A-Za-z._/:@-]+")
# without which containers.py cannot do; a master runs whatever there is
_NEEDED = {"robot": {"robot", "camera"}, "master": {"web"}}


class Sum(NamedTuple):
    size: int  # bytes
    sha256: str


class Manifest(NamedTuple):
    version: str
    files: Mapping[str, Sum]  # by name
    arena: str = ""  # the master's, if it serves this

    @property
    def size(self) -> int:
        """In bytes, all files."""
        return sum(one.size for one in self.files.values())

    def of(self, role: str) -> "Manifest":
        """That role's part."""
        return self._replace(files={name: one for name, one in self.files.items() if name.startswith(f"{role}/")})


class Source(Protocol):
    def read(self, size: int, /) -> bytes: ...


def render(manifest: Manifest) -> str:
    files = {name: one._asdict() for name, one in sorted(manifest.files.items())}
    document = {"format": FORMAT, "version": manifest.version, "arena": manifest.arena, "files": files}
    return json.dumps(document, indent=1) + "\n"


def parse(content: bytes) -> Manifest:
    """ValueError says what is wrong, for people."""
    try:
        document = json.loads(content)
        number, version, arena = document["format"], document["version"], document["arena"]
        files = {name: Sum(**one) for name, one in document["files"].items()}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise ValueError("is no update of LaserBot Battle") from None
    if number != FORMAT:
        raise ValueError(f"is of another kind ({number!r}) than this card knows ({FORMAT}): write the card itself anew")
    if not (isinstance(version, str) and _VERSION.fullmatch(version) and isinstance(arena, str)):
        raise ValueError("has no version that could be one")
    for name, (size, digest) in files.items():
        known = _FILE.fullmatch(name) and type(size) is int and _SUM.fullmatch(str(digest))
        if not (known and 0 <= size <= (LONGEST if name.endswith(".json") else _LARGEST)):
            raise ValueError("lists files that no card needs")
    for role in ROLES:
        _complete(role, files)
    return Manifest(version, files, arena)


def _complete(role: str, files: Iterable[str]) -> None:
    """ValueError if only some of the role's files are there."""
    own = {name for name in files if name.startswith(f"{role}/")}
    needed = {f"{role}/image.tar", *(f"{role}/containers/{name}.json" for name in _NEEDED[role])}
    if own and not needed <= own:
        raise ValueError(f"lacks {', '.join(sorted(needed - own))}")


def manifest_of(path: Path) -> Manifest:
    """What is in the archive. ValueError says why it cannot be used, for people."""
    try:
        with tarfile.open(path, "r:") as tar:
            first = tar.next()
            is_one = first and first.isreg() and first.name == MANIFEST and first.size <= LONGEST
            file = tar.extractfile(first) if first and is_one else None
            manifest = parse(file.read() if file else b"")
    except (tarfile.TarError, OSError, OverflowError):  # the last of a size that is none
        raise ValueError("is no update of LaserBot Battle, or broken: copy it again") from None
    if missing := [role for role in ROLES if not manifest.of(role).files]:
        raise ValueError(f"lacks what a {missing[0]}'s card needs")
    return manifest


def unpack(path: Path, manifest: Manifest, folder: Path) -> None:
    """Write the archive's files into the folder. ValueError unless they are those of the manifest."""
    missing = dict(manifest.files)
    try:
        with tarfile.open(path, "r:") as tar:
            for member in tar:
                if member.name == MANIFEST:
                    continue
                if member.name not in missing:
                    raise ValueError(f"holds more than it should: {member.name[:80]!r}")
                source = tar.extractfile(member) if member.isreg() else None
                if source is None:
                    raise ValueError(f"holds a link, a folder or a device as {member.name}")
                copy(source, folder / member.name, missing.pop(member.name))
    except (tarfile.TarError, OverflowError):
        raise ValueError("ends too early: copy it again") from None
    if missing:
        raise ValueError("ends too early: copy it again")
    check_descriptions(folder)


def copy(source: Source, target: Path, expected: Sum) -> None:
    """Write what is read, so that it outlasts the power. ValueError unless it is what was expected."""
    target.parent.mkdir(parents=True, exist_ok=True)
    digest, left = hashlib.sha256(), expected.size
    with target.open("xb") as file:
        while left and (chunk := source.read(min(left, _CHUNK))):
            file.write(chunk)
            digest.update(chunk)
            left -= len(chunk)
        file.flush()
        os.fsync(file.fileno())
    if left or digest.hexdigest() != expected.sha256:
        raise ValueError(f"is broken: {'/'.join(target.parts[-2:])} is not what it should be")


def check_descriptions(folder: Path) -> None:
    """ValueError unless each of the folder's containers/*.json describes a container."""
    for path in sorted(folder.glob("*/containers/*.json")):
        description(path)


def description(path: Path) -> dict[str, Any]:
    """The container that the file describes. ValueError if it describes none."""
    try:
        found = json.loads(path.read_bytes())
    except (ValueError, RecursionError):
        found = None
    if not (isinstance(found, dict) and _is_container(found)):
        raise ValueError(f"is broken: {path.name} describes no container")
    return found


def _is_container(found: dict[str, Any]) -> bool:
    """As far as the card itself reads it. The engine judges the rest."""
    image, environment = found.get("Image"), found.get("Env")
    return (
        isinstance(image, str)
        and bool(_IMAGE.fullmatch(image))
        and isinstance(environment, list)
        and all(isinstance(entry, str) and "=" in entry for entry in environment)
    )


def write(version: str, folder: Path, target: Path) -> None:
    """The same content gives the same bytes."""
    paths = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.is_file()}
    files = {}
    for name, path in paths.items():
        with path.open("rb") as file:
            files[name] = Sum(path.stat().st_size, hashlib.file_digest(file, "sha256").hexdigest())
    manifest = render(Manifest(version, files)).encode()
    parse(manifest)
    with tarfile.open(target, "w", format=tarfile.USTAR_FORMAT) as tar:
        _add(tar, MANIFEST, len(manifest), io.BytesIO(manifest))
        for name, path in paths.items():
            with path.open("rb") as file:
                _add(tar, name, files[name].size, file)


def _add(tar: tarfile.TarFile, name: str, size: int, content: Any) -> None:
    entry = tarfile.TarInfo(name)  # without owner and time
    entry.size = size
    tar.addfile(entry, content)


if __name__ == "__main__":
    write(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
