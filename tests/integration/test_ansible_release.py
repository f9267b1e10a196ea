"""ansible/roles/release: which services of a host are run anew, and which its image has no program for."""

import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from tests.support.programs import ROOT

ROLE = ROOT / "ansible/roles/release"
IMAGE = "registry/webserver@sha256:1"
WEB: dict[str, Any] = {
    "name": "laserbot-web",
    "command": ["python3", "-m", "server.main"],
    "env": {"LASERBOT_SEATS": "4"},
}
BOTS: dict[str, Any] = {"name": "laserbot-bots", "command": ["python3", "-m", "server.bots"], "env": {}}
ROBOT: dict[str, Any] = {"name": "laserbot-robot", "env": {}}  # what its image runs by itself
SERVICES = [WEB, BOTS, ROBOT]
NAMES = [service["name"] for service in SERVICES]


def told(expression: str, **variables: object) -> Any:
    """What the expression is, with the role's variables and these."""
    known = {"role_path": str(ROLE), "release_image": IMAGE, "release_services": SERVICES, **variables}
    run = subprocess.run(
        [
            *(ROOT / ".venv/bin/ansible", "localhost", "--inventory=localhost,", "--connection=local", "--one-line"),
            *("--module-name=ansible.builtin.debug", f"--args=msg={{{{ {expression} }}}}"),
            *(f"--extra-vars={each}" for each in (f"@{ROLE}/vars/main.yml", json.dumps(known))),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    return json.loads(run.stdout.partition("=>")[2])["msg"]


def to_run(*containers: str, **variables: object) -> list[str]:
    """Names of the services that are run anew beside these containers, as `docker ps` lists them."""
    names: list[str] = told(
        "release_to_run|map(attribute='name')", release_found={"stdout_lines": containers}, **variables
    )
    return names


def test_only_a_healthy_service_of_the_same_definition_is_left_alone() -> None:
    marks: Mapping[str, str] = told("release_made_from")
    known = {name: f"{name} {marks[name]}" for name in NAMES}
    same = [f"{each} Up 3 hours (healthy)" for each in known.values()]
    assert to_run(*same) == []
    assert to_run(*same, release_image="registry/webserver@sha256:2") == NAMES
    other = [{**WEB, "env": {"LASERBOT_SEATS": "5"}}, BOTS, ROBOT]
    assert to_run(*same, release_services=other) == ["laserbot-web"]
    ill = (
        f"{known['laserbot-web']} Up 3 hours (unhealthy)",
        f"{known['laserbot-bots']} Exited (0) 2 minutes ago",
        "laserbot-robot  Up 3 hours (healthy)",  # made by an earlier version of the role
    )
    assert to_run(*ill) == NAMES


def test_a_service_whose_program_the_image_lacks_is_known(tmp_path: Path) -> None:
    asked = told("release_ask + release_programs.values()")
    assert asked[-2:] == ["server.main", "server.bots"]
    (tmp_path / "server").mkdir()
    for module in ("__init__", "main"):
        (tmp_path / f"server/{module}.py").touch()
    ask = [sys.executable, *asked[asked.index("python3") + 1 :], "server.ros.master"]
    lacks = subprocess.run(ask, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert lacks.split() == ["server.bots", "server.ros.master"]
    assert told("release_lacking", release_lacks={"stdout": lacks}) == ["laserbot-bots"]


def test_an_image_without_a_program_of_the_core_is_refused_before_anything_runs() -> None:
    def lacking(*modules: str) -> object:
        lacks = {"stdout": " ".join(modules)}
        return told("release_lacking_core", release_lacks=lacks, release_core=["laserbot-web", "laserbot-rosbridge"])

    assert lacking("server.bots") == []
    assert lacking("server.bots", "server.main") == ["server.main"]
    tasks = yaml.safe_load((ROLE / "tasks/services.yml").read_text())
    (refuses,) = (i for i, task in enumerate(tasks) if "release_lacking_core | length == 0" in str(task))
    assert refuses < min(i for i, task in enumerate(tasks) if task["name"] in ("Run the service", "Remove the service"))


def test_a_run_that_is_broken_off_leaves_no_service_without_what_restarts_it() -> None:
    """The next run does nothing where all services are healthy."""
    names = [task["name"] for task in yaml.safe_load((ROLE / "tasks/services.yml").read_text())]
    restart = names.index("Restart what crashes, even if stop.yml had stopped the services")
    assert restart < names.index("Run the service")
