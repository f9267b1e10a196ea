"""Containers of our images, started as hardened as they are meant to run."""

import json
import subprocess
import time
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from tests.support.polling import until

HARDENED = [
    "--read-only",
    "--cap-drop=ALL",
    "--security-opt=no-new-privileges",
    "--tmpfs=/run/laserbot:uid=10001,mode=0700",
]

# The cores of a Raspberry Pi 4 and 2. qemu's own choice can more than these, and takes 15 s to compute the pointer
# authentication of Python's start.
EMULATED_CPU = {"linux/arm64": "cortex-a72", "linux/arm/v7": "cortex-a7"}


def docker(*arguments: str) -> str:
    """What `docker` prints; AssertionError with its complaint if it fails."""
    result = subprocess.run(["docker", *arguments], capture_output=True, text=True, check=False)
    assert result.returncode == 0, f"docker {' '.join(arguments)}: {result.stdout}{result.stderr}"
    return result.stdout


def emulation(platform: str) -> dict[str, str]:
    """The variables with which a container of this platform is emulated; without effect where it is native."""
    return {"QEMU_CPU": EMULATED_CPU[platform]} if platform in EMULATED_CPU else {}


def run(image: str, platform: str, *command: str) -> str:
    """What a hardened container without a network prints."""
    variables = [f"--env={name}={value}" for name, value in emulation(platform).items()]
    return docker("run", "--rm", f"--platform={platform}", "--network=none", *variables, *HARDENED, image, *command)


class Container:
    """A running container; a context manager that removes it."""

    def __init__(
        self,
        image: str,
        platform: str,
        *command: str,
        network: str = "none",
        name: str = "",
        env: Mapping[str, str] | None = None,
        options: Sequence[str] = (),
    ) -> None:
        flags = [f"--platform={platform}", f"--network={network}", *HARDENED, *options]
        flags += [f"--env={key}={value}" for key, value in {**emulation(platform), **(env or {})}.items()]
        flags += [f"--network-alias={name}"] if name else []
        self._created = time.monotonic()
        self.id = docker("run", "--detach", *flags, image, *command).strip()

    def __enter__(self) -> "Container":
        return self

    def __exit__(self, *_: object) -> None:
        docker("rm", "--force", "--volumes", self.id)

    @property
    def state(self) -> dict[str, Any]:
        return dict(json.loads(docker("inspect", "--format", "{{json .State}}", self.id)))

    @property
    def logs(self) -> str:
        result = subprocess.run(["docker", "logs", self.id], capture_output=True, text=True, check=True)
        return result.stdout + result.stderr

    def run(self, *command: str) -> str:
        """What a command inside prints."""
        return docker("exec", self.id, *command)

    def stop(self) -> float:
        """As an operator would: by the image's stop signal; s until the end of a program that ends well."""
        began = datetime.now(UTC)
        docker("stop", "--time", "10", self.id)
        assert self.state["ExitCode"] in {0, 130}, f"{self.state}\n{self.logs}"
        return (datetime.fromisoformat(str(self.state["FinishedAt"])) - began).total_seconds()

    def wait_until_healthy(self, seconds: float = 120.0) -> float:
        """Wait for Docker's word; s since the container was created."""

        def healthy() -> bool:
            state = self.state
            assert state["Running"], f"the container has ended: {state}\n{self.logs}"
            return bool(state["Health"]["Status"] == "healthy")

        try:
            until(healthy, seconds)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.state}\n{self.logs}") from None
        return time.monotonic() - self._created
