"""The demo of compose.yaml, on free ports, under a project name of its own."""

import json
import os
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Self

from tests.support.containers import emulation, engine
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import ROOT


class ComposeBattle:
    """`docker compose --profile demo up`, with no robot for bots; what tests.support.battle.Battle is to `make demo`.

    `platforms` names the services that are emulated, `variables` are LASERBOT_ settings.
    """

    def __init__(self, folder: Path, platforms: Mapping[str, str], **variables: str) -> None:
        self.web_port, self.rosbridge_port, self.relay_port, self.arena_port = (free_port() for _ in range(4))
        self.web = f"http://127.0.0.1:{self.web_port}"
        self.bridge = f"ws://127.0.0.1:{self.rosbridge_port}"
        self.view = f"ws://127.0.0.1:{self.arena_port}/view"
        self._environment = {
            **os.environ,
            "LASERBOT_WEB_PORT": str(self.web_port),
            "LASERBOT_ROSBRIDGE_PORT": str(self.rosbridge_port),
            "LASERBOT_RELAY_PORT": str(self.relay_port),
            "LASERBOT_ARENA_PORT": str(self.arena_port),
            "LASERBOT_BOT_ROBOTS": "",
            **variables,
        }
        services = {
            name: {"platform": platform, "environment": emulation(platform)} for name, platform in platforms.items()
        }
        override = folder / "compose.platforms.yaml"
        override.write_text(json.dumps({"services": services}))  # JSON is YAML
        # not the operator's own settings beside compose.yaml
        self._options = ["--env-file=/dev/null", "--project-name", f"laserbot-test-{os.getpid()}"]
        self._options += ["--file", str(ROOT / "compose.yaml"), "--file", str(override)]

    def compose(self, *words: str) -> str:
        result = subprocess.run(
            ["docker", "compose", *self._options, "--profile", "demo", *words],
            env=self._environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert result.returncode == 0, f"docker compose {' '.join(words)}: {result.stdout}{result.stderr}"
        return result.stdout

    @property
    def services(self) -> list[str]:
        return self.compose("ps", "--services").split()

    def container(self, service: str) -> str:
        return self.compose("ps", "--quiet", service).strip()

    def crash(self, service: str) -> None:
        """Kill the main process as an operator cannot: Docker takes `docker kill` for a wish to have it stopped."""
        container = engine().containers.get(self.container(service))
        before = container.attrs["State"]["Pid"]
        image = engine().containers.get(self.container("arena")).attrs["Image"]
        kill = ["sh", "-c", f"kill -KILL {before}"]
        engine().containers.run(image, kill, remove=True, pid_mode="host", user="0", network_mode="none")

        def is_back() -> bool:
            container.reload()
            return container.attrs["State"]["Pid"] not in {before, 0}

        until(is_back, 20, f"{service} is started again")

    def wait_until_healthy(self, seconds: float = 60.0) -> None:
        def unhealthy() -> list[str]:
            rows = [json.loads(line) for line in self.compose("ps", "--all", "--format", "json").splitlines()]
            return [row["Service"] for row in rows if row["Health"] != "healthy"]

        try:
            until(lambda: not unhealthy(), seconds, "every container is healthy")
        except AssertionError as error:
            raise AssertionError(f"{error}: {unhealthy()}\n{self.compose('logs', '--tail=20')}") from None

    def __enter__(self) -> Self:
        try:
            self.compose("up", "--detach", "--pull=never", "--no-build")
            self.wait_until_healthy(120)
        except AssertionError:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.compose("down", "--volumes", "--timeout", "5")
