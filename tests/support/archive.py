"""Archives of images as `make images ARCHIVE=...` writes them, without anything that is large."""

import hashlib
import io
import json
import tarfile
from collections.abc import Mapping
from pathlib import Path

from tests.support.imagefile import IMAGES, version

PLATFORMS = ("amd64", "arm64")


def digest_of(content: bytes) -> str:
    return f"sha256:{hashlib.sha256(content).hexdigest()}"


class Archive:
    """An archive of all images. `built` says what is in them: a word by image; the same word gives the same digests."""

    def __init__(self, path: Path, built: Mapping[str, str] | None = None, by_digest: bool = True) -> None:
        self.path = path
        self.digests: dict[str, str] = {}
        self.manifests: dict[tuple[str, str], str] = {}  # by image and platform
        self.settings: dict[tuple[str, str], str] = {}  # the same: what containerd calls the image's ID
        self._blobs: dict[str, bytes] = {}
        entries = []
        for image in IMAGES:
            self._add(image, (built or {}).get(image, "first"))
            digest = self.digests[image]
            for tag in (version(), *([f"{version()}-{digest.replace(':', '-')}"] if by_digest else ())):
                names = {
                    "io.containerd.image.name": f"docker.io/library/{image}:{tag}",
                    "org.opencontainers.image.ref.name": tag,
                }
                entries.append({"digest": digest, "annotations": names})
        with tarfile.open(path, "w") as tar:
            for name, content in {**self._blobs, "index.json": json.dumps({"manifests": entries}).encode()}.items():
                entry = tarfile.TarInfo(name)
                entry.size = len(content)
                tar.addfile(entry, io.BytesIO(content))

    def _blob(self, content: object) -> str:
        text = json.dumps(content).encode()
        digest = digest_of(text)
        self._blobs[f"blobs/{digest.replace(':', '/')}"] = text
        return digest

    def _add(self, image: str, word: str) -> None:
        manifests = []
        for platform in PLATFORMS:
            settings = self._blob({"image": image, "architecture": platform, "built": word})
            self.settings[image, platform] = settings
            manifest = self._blob({"config": {"digest": settings}, "layers": []})
            self.manifests[image, platform] = manifest
            manifests.append({"digest": manifest, "platform": {"architecture": platform}})
        self.digests[image] = self._blob({"manifests": manifests})
