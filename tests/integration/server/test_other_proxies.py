"""Proxies of other people before the game, as docs/front.md tells them to: at the ports that stand there."""

import json
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import yaml

from tests.support.documents import page
from tests.support.lan import Machine, needs_root
from tests.support.polling import until
from tests.support.programs import ROOT, Program

PAGE = page("front.md")
OWN, FOREIGN = "http://arena.example", "http://evil.example"
FOREIGN_PAGE = "this page is not at the game's own address"
OTHER_SITE = "the page of 127.0.0.1 belongs to another web site"


def snippet(language: str) -> str:
    (text,) = re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    return str(text)


class Master:
    """All programs of the master, at their usual ports of a machine of their own."""

    def __init__(self, machine: Machine, folder: Path) -> None:
        self.machine = machine
        self._env = {
            "ROS_MASTER_URI": "http://localhost:11311",
            "ROS_IP": "127.0.0.1",
            "ROS_HOME": str(folder / "ros"),
            "ROS_LOG_DIR": str(folder / "ros" / "log"),
            "LASERBOT_DATA": str(folder / "data"),
            "LASERBOT_ORIGINS": OWN,
        }
        ready = {
            "server.main": "serving the game",
            "server.rosbridge": "listening",
            "server.camera": "listening",
        }
        self.programs = {"server.ros.master": self._start("server.ros.master")}
        self.programs.update({module: self._start(module) for module in ready})
        for module, word in ready.items():
            self.programs[module].wait_for(word)

    def _start(self, module: str) -> Program:
        return self.machine.python(module, env=self._env)

    def stop(self) -> None:
        for program in reversed(self.programs.values()):
            program.stop()

    def visited_from(self, origin: str, name: str) -> dict[str, object]:
        found: dict[str, object] = json.loads(
            self.machine.run(sys.executable, "-m", "tests.integration.server.visitor", origin, name)
        )
        return found


@pytest.fixture(scope="module")
def master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Master]:
    with ExitStack() as stack:
        running = Master(stack.enter_context(Machine()), tmp_path_factory.mktemp("master"))
        stack.callback(running.stop)
        yield running


def nginx(folder: Path) -> list[str]:
    (folder / "conf.d").mkdir()
    (folder / "conf.d" / "arena.conf").write_text(snippet("nginx"))
    (folder / "nginx.conf").write_text(
        f"daemon off; user root; pid {folder}/pid; events {{}}\nhttp {{ access_log off; include conf.d/*.conf; }}\n"
    )
    return ["/usr/sbin/nginx", "-p", str(folder), "-e", "stderr", "-c", f"{folder}/nginx.conf"]


def haproxy(folder: Path) -> list[str]:
    (folder / "haproxy.cfg").write_text(snippet("haproxy"))
    return ["/usr/sbin/haproxy", "-db", "-f", f"{folder}/haproxy.cfg"]


def apache(folder: Path) -> list[str]:
    modules = ("mpm_event", "authz_core", "proxy", *re.findall(r"`a2enmod (.*?)`", PAGE)[0].split())
    loaded = [f"LoadModule {name}_module /usr/lib/apache2/modules/mod_{name}.so" for name in modules]
    own = ["Listen 80", "User nobody", "Group nogroup", f"DefaultRuntimeDir {folder}", f"PidFile {folder}/pid"]
    rest = ["DocumentRoot /srv", "ErrorLog /dev/stderr", snippet("apache")]
    (folder / "apache2.conf").write_text("\n".join([*loaded, *own, *rest]))
    return ["/usr/sbin/apache2", "-DFOREGROUND", "-f", f"{folder}/apache2.conf"]


def caddy(folder: Path) -> list[str]:
    """Installed, its service would take port 80."""
    (folder / "Caddyfile").write_text(snippet("caddyfile"))
    unpacked = subprocess.run(
        [ROOT / "ci/unpack", "caddy"], stdout=subprocess.PIPE, text=True, check=True
    ).stdout.strip()
    run = ["caddy", "run", "--adapter", "caddyfile", "--config", f"{folder}/Caddyfile"]
    return [
        "env",
        f"HOME={folder}",
        f"XDG_DATA_HOME={folder}",
        f"XDG_CONFIG_HOME={folder}",
        f"{unpacked}/usr/bin/{run[0]}",
        *run[1:],
    ]


@needs_root
@pytest.mark.parametrize(
    "proxy",
    [nginx, *(pytest.param(one, marks=pytest.mark.slow) for one in (haproxy, apache, caddy))],
    ids=lambda proxy: proxy.__name__,
)
def test_a_visitor_of_the_proxy_plays_as_at_the_front(
    master: Master, proxy: Callable[[Path], list[str]], tmp_path: Path
) -> None:
    program = master.machine.program(*proxy(tmp_path))
    try:
        knock = master.machine.command("bash", "-c", "exec 3<>/dev/tcp/127.0.0.1/80")
        until(lambda: subprocess.run(knock, capture_output=True, check=False).returncode == 0, 20, "it listens")
        game, rosbridge = master.programs["server.main"], master.programs["server.rosbridge"]
        before = rosbridge.output.count(OTHER_SITE)
        own = master.visited_from(OWN, proxy.__name__)
        assert FOREIGN_PAGE not in str(own.pop("camera"))
        shown = {"address": True, "front": True, "rosbridge": "publish"}
        assert own == {"form": 200, "cookie": True, **shown}
        assert rosbridge.output.count(OTHER_SITE) == before
        foreign = master.visited_from(FOREIGN, "evil")
        assert FOREIGN_PAGE in str(foreign.pop("camera"))
        assert foreign == {"form": 403, "cookie": False, **shown}
        assert rosbridge.output.count(OTHER_SITE) == before + 1
        assert "/signUpUser from 127.0.0.1 refused" in game.output
        assert "9.9.9.9" not in game.output
    finally:
        program.stop()


def test_traefik_is_told_the_same_as_on_kubernetes() -> None:
    told = yaml.safe_load(snippet("yaml"))["http"]
    found = {
        router["rule"].removeprefix("Host(`arena.example`)").removeprefix(" && "): (
            told["services"][router["service"]]["loadBalancer"]["servers"][0]["url"],
            [told["middlewares"][name] for name in router["middlewares"]],
            router["priority"],
        )
        for router in told["routers"].values()
    }
    ports = {"web": 5000, "rosbridge": 9090, "relay": 9091}
    routes = list(yaml.safe_load_all((ROOT / "k3s/components/ingress/routes.yaml").read_text()))
    middlewares = {item["metadata"]["name"]: item["spec"] for item in routes if item["kind"] == "Middleware"}
    expected = {
        "" if rule["match"] == "PathPrefix(`/`)" else rule["match"]: (
            f"http://127.0.0.1:{ports[rule['services'][0]['port']]}",
            [middlewares[one["name"]] for one in rule["middlewares"]],
            rule["priority"],
        )
        for item in routes
        if item["kind"] == "IngressRoute" and item["spec"]["entryPoints"] == ["websecure"]
        for rule in item["spec"]["routes"]
    }
    assert found == expected
