"""Containers of our images, started as hardened as they are meant to run."""

import time
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

import docker
from docker.models import containers
from docker.types import Mount

from tests.support.polling import until

HARDENED: dict[str, Any] = {
    "read_only": True,
    "cap_drop": ["ALL"],
    "security_opt": ["no-new-privileges"],
    "tmpfs": {"/run/laserbot": "uid=10001,mode=0700"},
}

# The cores of a Raspberry Pi 4 and 2. qemu's own choice can more than these, and takes 15 s to compute the pointer
# authentication of Python's start.
EMULATED_CPU = {"linux/arm64": "cortex-a72", "linux/arm/v7": "cortex-a7"}
PATIENCE = 180  # s for an answer of the engine


@cache
def engine() -> docker.DockerClient:
    """The engine of DOCKER_HOST, else this machine's own."""
    return docker.from_env(timeout=PATIENCE)


def emulation(platform: str) -> dict[str, str]:
    """The variables with which a container of this platform is emulated; without effect where it is native."""
    return {"QEMU_CPU": EMULATED_CPU[platform]} if platform in EMULATED_CPU else {}


def run(image: str, platform: str, *command: str) -> str:
    """What a hardened container without a network prints; ContainerError if it fails."""
    output: bytes = engine().containers.run(
        image,
        list(command),
        remove=True,
        platform=platform,
        network_mode="none",
        environment=emulation(platform),
        **HARDENED,
    )
    return output.decode()


def execute(container: containers.Container, *command: str) -> str:
    """What a command inside prints; AssertionError with its complaint if it fails."""
    result: Any = container.exec_run(list(command), demux=True)  # the stubs know of no demultiplexed output
    output, complaint = (text.decode() if text else "" for text in result.output)
    assert result.exit_code == 0, f"{command}: {output}{complaint}"
    return output


def remove(which: Iterable[containers.Container]) -> None:
    """With their anonymous volumes."""
    for container in which:
        container.remove(force=True, v=True)


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
        volumes: Iterable[str] = (),
    ) -> None:
        """`name` is its own in the network, `volumes` are paths inside."""
        options: dict[str, Any] = {"network_mode": network}
        if name:
            options = {
                "network": network,
                "networking_config": {network: engine().api.create_endpoint_config(aliases=[name])},
            }
        self._created = time.monotonic()
        self._container = engine().containers.run(
            image,
            list(command) or None,
            detach=True,
            platform=platform,
            environment={**emulation(platform), **(env or {})},
            mounts=[Mount(path, None, type="volume") for path in volumes],
            **options,
            **HARDENED,
        )

    def __enter__(self) -> "Container":
        return self

    def __exit__(self, *_: object) -> None:
        remove([self._container])

    @property
    def id(self) -> str:
        return str(self._container.id)

    @property
    def state(self) -> dict[str, Any]:
        self._container.reload()
        return dict(self._container.attrs["State"])

    @property
    def logs(self) -> str:
        output: bytes = self._container.logs()
        return output.decode(errors="replace")

    def run(self, *command: str) -> str:
        """What a command inside prints."""
        state = self.state
        assert state["Running"], f"the container has ended: {state}\n{self.logs}"
        return execute(self._container, *command)

    def stop(self) -> None:
        """As an operator would: by the image's stop signal. The program must end well, and not have to be killed."""
        self._container.stop(timeout=10)
        assert self.state["ExitCode"] in {0, 130}, f"{self.state}\n{self.logs}"

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
