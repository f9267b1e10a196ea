#!/usr/bin/env python3
"""Makes the kustomizations of several arenas, and the list that their entrance reads, from a file of a few lines each.

    k3s/arenas.py k3s/overlays/arenas     then kubectl apply -k k3s/overlays/arenas

FOLDER/red.yaml is the arena red (docs/kubernetes-arenas.md); FOLDER/made is written anew. What is wrong is told in one
line, and nothing is written then.
"""

import argparse
import difflib
import json
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any

try:
    import yaml
except ImportError:
    sys.exit("k3s/arenas.py: PyYAML is missing: apt-get install python3-yaml")

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "laser_bot_battle/src")]

from laser_bot_battle.arena_list import read_arenas  # noqa: E402 - the path has to be there first
from laser_bot_battle.settings import SettingsError  # noqa: E402
from laser_bot_battle.variables import BOT_ROBOTS  # noqa: E402
from server.game.rules import DECLARED  # noqa: E402

MADE = "made"
ROBOTS = 2  # unless an arena says otherwise, as in overlays/sim
PORTS = range(30000, 32768)  # what Kubernetes gives to Services
ENTRANCE_PORT = 30505  # k3s/components/entrance
USES = ("web", "rosbridge", "view", "relay")  # in the order of an arena's ports
_RULES = {variable.name: variable for variable in DECLARED.values()}
_FIELDS = ("namespace", "port", "host", "rules", "robots", "bots", "components")
# of k3s/components, what an arena's file does not name, and why
_ELSEWHERE = {
    **dict.fromkeys(
        ("entrance", "entrance-host", "leaderboard", "leaderboard-backups", "registry"),
        "serves all arenas: name it in the kustomization that has made in its resources",
    ),
    **dict.fromkeys(
        ("certificate", "front", "gateway", "host-name", "ingress", "node-ports", "proxy"),
        "is a way in, which port or host chooses",
    ),
    **dict.fromkeys(
        ("announcer", "bots", "camera", "device-plugin", "overhead"), "is for real robots, which overlays/lan has"
    ),
    "network-policies": "is part of every arena",
}
_WATCHING = ("metrics", "monitoring", "prometheus-operator")  # of which the others include the first
_LABEL = r"[a-z0-9](?:[a-z0-9-]*[a-z0-9])?"
_NAME = re.compile(rf"(?=.{{1,40}}$){_LABEL}")
_NAMESPACE = re.compile(rf"(?=.{{1,63}}$){_LABEL}")
# a cluster's own namespaces, whose pods would lose rights, and those of the parts that serve all arenas
_OTHERS = re.compile(r"default|kube-.*|laserbot-(?:entrance|leaderboard)")
_HOST = re.compile(rf"(?=.{{1,253}}$){_LABEL}(?:\.{_LABEL})+")
_HEAD = "---\n# Made by k3s/arenas.py from {source}: change that, and run it again.\n"


class WrongError(Exception):
    """What is wrong with which file, in one line."""


@dataclass(frozen=True)
class Arena:
    """What its file says."""

    name: str
    namespace: str
    port: int | None  # the first of its four, on every node's address
    host: str  # in place of ports
    settings: tuple[str, ...]
    replicas: tuple[tuple[str, int], ...]
    components: tuple[str, ...]

    @property
    def ports(self) -> range:
        return range(self.port, self.port + len(USES)) if self.port else range(0)

    @property
    def listed(self) -> str:
        """For LASERBOT_ARENAS."""
        public = f":{self.port}" if self.port else f"https://{self.host}"
        return f"{self.name}={public}@master.{self.namespace}:5000"


def main(words: Sequence[str] | None = None) -> int:
    """Exit code 0 when the folder is written, 1 when a file is wrong."""
    parser = argparse.ArgumentParser("k3s/arenas.py", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, help="with a file for each arena, such as red.yaml")
    folder = parser.parse_args(words).folder
    try:
        arenas = read(folder)
        write(arenas, folder)
    except (WrongError, OSError) as error:
        print(f"k3s/arenas.py: {error}", file=sys.stderr)
        return 1
    domain = common_domain(arenas)
    shared = f"share players' sessions by {domain}" if domain else "share no sessions: they have no common domain"
    print(f"{folder / MADE}: {len(arenas)} arenas, which {shared}")
    return 0


def read(folder: Path) -> list[Arena]:
    """The arenas by their names. WrongError."""
    files = sorted(file for file in folder.glob("*.y*ml") if file.stem != "kustomization")
    if not files:
        raise WrongError(f"{folder} has no file of an arena, such as red.yaml")
    arenas = [_arena(file) for file in files]
    _refuse_shared(arenas, lambda arena: [arena.namespace], "namespace")
    _refuse_shared(arenas, lambda arena: [arena.host] if arena.host else [], "host")
    _refuse_shared(arenas, lambda arena: arena.ports, "port")
    read_arenas(" ".join(arena.listed for arena in arenas))
    return arenas


def common_domain(arenas: Sequence[Arena]) -> str:
    """For LASERBOT_DOMAIN; "": there is none."""
    if all(arena.port for arena in arenas):
        return "*"
    if any(arena.port for arena in arenas):
        return ""
    above = [arena.host.split(".")[:0:-1] for arena in arenas]  # the last label first, and without the host's own
    common = [each[0] for each in takewhile(lambda each: len({*each}) == 1, zip(*above, strict=False))]
    return ".".join(reversed(common)) if len(common) > 1 else ""


def write(arenas: Sequence[Arena], folder: Path) -> None:
    """Each arena's kustomization, and one of all."""
    made = folder / MADE
    if made.exists() and not (made / "kustomization.yaml").exists():
        raise WrongError(f"{made} is not what this program has made: it is left alone")
    shutil.rmtree(made, ignore_errors=True)
    domain = common_domain(arenas)
    listed = " ".join(arena.listed for arena in arenas)
    _write(
        made,
        "the files beside this folder",
        [
            "resources:",
            *(f"  - {arena.name}" for arena in arenas),
            "configMapGenerator:",
            "  - name: arenas # for components/entrance",
            "    literals:",
            f"      - {_text(f'list={listed}')}",
            f"      - {_text(f'domain={domain}')}",
            *([f"      - {_text(f'host={domain}')} # for components/entrance-host"] if "." in domain else []),
            '    options: {annotations: {config.kubernetes.io/local-config: "true"}} # only kustomize reads it',
        ],
    )
    for arena in arenas:
        _write(made / arena.name, f"{arena.name}.yaml", _kustomization(arena, domain, _way(made / arena.name)))


def _arena(file: Path) -> Arena:
    def wrong(what: str) -> WrongError:
        return WrongError(f"{file}: {what}")

    if file.suffix != ".yaml":
        raise wrong(f"its name must be {file.stem}.yaml")
    if not _NAME.fullmatch(file.stem):
        raise wrong("an arena's name, which its file has, is of small letters, digits and -, at most 40")
    try:
        told = yaml.safe_load(file.read_text())
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise wrong(" ".join(str(error).split())) from None
    if not isinstance(told, dict):
        raise wrong("it must have lines such as namespace: laserbot-red and port: 30510")
    for field in told:
        if field not in _FIELDS:
            raise wrong(f"there is no {field}{_nearest(field, _FIELDS)}")
    port, host = told.get("port"), told.get("host")
    if (port is None) == (host is None):
        raise wrong("it must have either a port or a host")
    if port is not None and (type(port) is not int or port not in PORTS or port + len(USES) - 1 not in PORTS):
        raise wrong(f"port must be from {PORTS[0]} to {PORTS[-len(USES)]}: the next three are the arena's, too")
    if port is not None and ENTRANCE_PORT in range(port, port + len(USES)):
        raise wrong(f"port {ENTRANCE_PORT} is the entrance's")
    if host is not None and (not isinstance(host, str) or not _HOST.fullmatch(host)):
        raise wrong("host must be a name such as red.arena.example")
    try:
        namespace = _namespace(told.get("namespace"))
        settings = (*_settings(told.get("rules")), *_bots(told))
        components = _components(told.get("components"))
        return Arena(file.stem, namespace, port, host or "", settings, _replicas(told), components)
    except ValueError as error:
        raise wrong(str(error)) from None


def _namespace(name: Any) -> str:
    if not isinstance(name, str) or not _NAMESPACE.fullmatch(name):
        raise ValueError("namespace must be of small letters, digits and -, at most 63")
    if _OTHERS.fullmatch(name):
        raise ValueError(f"namespace {name} is not an arena's: it has other things in it")
    return name


def _settings(rules: Any) -> tuple[str, ...]:
    if not isinstance(rules or {}, dict):
        raise ValueError("rules must be like {LASERBOT_HIT_DAMAGE: 20}")
    for name, value in (rules or {}).items():
        if name not in _RULES:
            raise ValueError(f"there is no rule {name}{_nearest(name, _RULES)}")
        try:
            _RULES[name].read({name: str(value)})
        except SettingsError as error:
            raise ValueError(str(error)) from None
    return tuple(f"{name}={value}" for name, value in (rules or {}).items())


def _components(names: Any) -> tuple[str, ...]:
    there = sorted(folder.name for folder in (HERE / "components").iterdir())
    if not isinstance(names or [], list):
        raise ValueError("components must be like [kept-data, backups]")
    for name in names or []:
        if name not in there:
            raise ValueError(f"there is no component {name}{_nearest(name, there)}")
        if name in _ELSEWHERE:
            raise ValueError(f"the component {name} {_ELSEWHERE[name]}")
    found = tuple(names or [])
    if len({*found}) < len(found):
        raise ValueError("a component is named twice")
    if len({*found} & {*_WATCHING}) > 1:
        raise ValueError(f"only one of the components {', '.join(_WATCHING)} can be used")
    if "backups" in found and "kept-data" not in found:
        raise ValueError("the component backups needs kept-data")
    return found


def _nearest(name: object, known: Iterable[str]) -> str:
    """The end of a message."""
    nearest = difflib.get_close_matches(str(name), known, 1)
    return f"; the nearest is {nearest[0]}" if nearest else ""


def _replicas(told: dict[str, Any]) -> tuple[tuple[str, int], ...]:
    found = []
    for field, workload, lowest in (("robots", "robot", 1), ("bots", "bot", 0)):
        count = told.get(field)
        if count is None:
            continue
        if type(count) is not int or not lowest <= count <= 128:
            raise ValueError(f"{field} must be a whole number from {lowest} to 128")
        found.append((workload, min(count, 1) if field == "bots" else count))  # all bots are one program's
    return tuple(found)


def _bots(told: dict[str, Any]) -> tuple[str, ...]:
    """The last robots are theirs: people get the first ones."""
    robots, bots = told.get("robots", ROBOTS), told.get("bots")
    if type(robots) is not int or type(bots) is not int:
        return ()  # `_replicas` says what is wrong with them
    return (f"{BOT_ROBOTS.name}={' '.join(map(str, range(max(0, robots - bots), robots)))}",)


def _refuse_shared(arenas: Iterable[Arena], has: Callable[[Arena], Iterable[object]], what: str) -> None:
    owners: dict[object, str] = {}
    for arena in arenas:
        for one in has(arena):
            if one in owners:
                raise WrongError(f"{arena.name}.yaml and {owners[one]}.yaml have the same {what}: {one}")
            owners[one] = arena.name


def _way(folder: Path) -> str:
    """To this folder, from there: kustomize takes relative paths only."""
    return os.path.relpath(HERE, folder.resolve())


def _kustomization(arena: Arena, domain: str, here: str) -> list[str]:
    settings = [f"LASERBOT_DOMAIN={domain}"] if domain else []
    settings += arena.settings
    components = [*(["node-ports"] if arena.port else ["ingress", "host-name"]), *arena.components]
    lines = [
        f"namespace: {arena.namespace}",
        f"resources: [{here}/overlays/sim]",
        f"components: [{', '.join(f'{here}/components/{name}' for name in components)}]",
        "configMapGenerator:",
    ]
    if arena.port:
        ports = ", ".join(f"{use}={port}" for use, port in zip(USES, arena.ports, strict=True))
        lines.append(f"  - {{name: node-ports, behavior: merge, literals: [{ports}]}}")
    else:
        local = '{annotations: {config.kubernetes.io/local-config: "true"}}'
        lines.append(f"  - {{name: host-name, literals: [host={arena.host}], options: {local}}}")
    if settings:
        lines.append(f"  - {{name: settings, behavior: merge, literals: [{', '.join(map(_text, settings))}]}}")
    if arena.replicas:
        counts = ", ".join(f"{{name: {name}, count: {count}}}" for name, count in arena.replicas)
        lines.append(f"replicas: [{counts}]")
    return lines


def _text(text: str) -> str:
    """As YAML in double quotes."""
    return json.dumps(text)


def _write(folder: Path, source: str, lines: Iterable[str]) -> None:
    folder.mkdir()
    kind = ("apiVersion: kustomize.config.k8s.io/v1beta1", "kind: Kustomization")
    text = "".join(f"{line}\n" for line in (*kind, *lines))
    (folder / "kustomization.yaml").write_text(_HEAD.format(source=source) + text)


if __name__ == "__main__":
    sys.exit(main())
