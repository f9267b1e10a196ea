"""What images/Dockerfile and docker-bake.hcl say about the images, without building them."""

import json
import re
import shlex
from dataclasses import dataclass, field
from functools import cache

from tests.support.programs import ROOT

IMAGES = ("webserver", "rosberry", "sim", "monitoring")


@dataclass
class ImageConfig:
    """As far as manifests depend on it."""

    user: str = ""
    command: list[str] = field(default_factory=list)
    health: list[str] = field(default_factory=list)
    ports: set[int] = field(default_factory=set)
    environment: dict[str, str] = field(default_factory=dict)


@cache
def dockerfile(image: str) -> ImageConfig:
    """The configuration of the stage that is this image, with those that it is built on."""
    text = (ROOT / "images/Dockerfile").read_text()
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    config, inside = ImageConfig(), False
    for line in "\n".join(lines).replace("\\\n", " ").splitlines():
        word, _, rest = line.partition(" ")
        if word == "FROM":
            inside = rest.split(" AS ")[-1] in {"image", image}
        elif inside:
            _read(config, word, rest.strip())
    return config


def _read(config: ImageConfig, word: str, rest: str) -> None:
    match word:
        case "USER":
            config.user = rest
        case "CMD":
            config.command = json.loads(rest)
        case "HEALTHCHECK":
            config.health = json.loads(rest[rest.index("CMD") + 3 :])
        case "EXPOSE":
            config.ports = {int(number) for number in rest.split()}
        case "ENV":
            config.environment |= dict(pair.split("=", 1) for pair in shlex.split(rest))


@cache
def platforms(image: str, *, fewer: bool = False) -> set[str]:
    """Of docker-bake.hcl: linux/amd64, ... `fewer`: with FEWER_PLATFORMS."""
    text = (ROOT / "docker-bake.hcl").read_text()
    (line,) = re.findall(rf'^target "{image}" {{\n.*?platforms = (.*?)\n', text, re.MULTILINE | re.DOTALL)
    lists = re.findall(r"\[.*?\]", line)
    return set(json.loads(lists[0] if fewer else lists[-1]))


def folders(image: str) -> set[str]:
    """The folders of this repository whose programs are inside."""
    text = (ROOT / "images/Dockerfile").read_text()
    (stage,) = re.findall(rf"^FROM health AS parts-{image}\n(.*?)\n\n", text, re.MULTILINE | re.DOTALL)
    return set(re.findall(r"/opt/laserbot/(\w+)", stage))


def version() -> str:
    """The images' tag."""
    text = (ROOT / "laser_bot_battle/package.xml").read_text()
    return str(re.findall(r"<version>(.*)</version>", text)[0])
