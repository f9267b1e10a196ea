"""python3 -m laser_bot_battle.check: all mistakes in an environment, in a file of settings or in manifests, at once."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from laser_bot_battle.check import groups_of, mistakes
from laser_bot_battle.given_settings import Given
from tests.support.programs import ROOT


def wrong(**environ: str) -> list[str]:
    return list(mistakes({name: Given(value) for name, value in environ.items()}))


def in_file(text: str) -> list[str]:
    """What is wrong with settings in a file, or with manifests."""
    groups, lines = groups_of(text)
    return [*lines, *(line for group in groups for line in mistakes(group))]


def run(*arguments: str, given: str = "", **environ: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "laser_bot_battle.check", *arguments],
        env={"PATH": os.environ["PATH"], "PYTHONPATH": str(ROOT / "build/python"), **environ},
        input=given,
        capture_output=True,
        text=True,
        check=False,
    )


def test_all_mistakes_are_told_in_one_go() -> None:
    assert sorted(
        wrong(
            LASERBOT_HIT_DAMAGE="lots",
            LASERBOT_TEAMS="7",
            LASERBOT_BATLE_LIMIT="60",
            ROS_HOSTNAME="two names",
            LASERBOT_WEB_PORT="80",
        )
    ) == [
        "LASERBOT_BATLE_LIMIT: there is no such setting; the nearest is LASERBOT_BATTLE_LIMIT",
        "LASERBOT_HIT_DAMAGE=lots: must be a whole number from 1 to 100",
        "LASERBOT_TEAMS=7: must be 0, 2, 3 or 4",
        "ROS_HOSTNAME=two names: must be a name or an address of this machine, and no more",
    ]


BAD = {
    "LASERBOT_WEB_PORT": "65536",
    "LASERBOT_COUNTDOWN": "soon",
    "LASERBOT_FRIENDLY_FIRE": "yes",
    "LASERBOT_LIGHT": "red",
    "LASERBOT_ROSTER": "a=1 b=1",
    "LASERBOT_LED": "28",
    "LASERBOT_SERIAL": "tcp-listen://:0",
    "LASERBOT_ORIGINS": "arena.example",
    "LASERBOT_PROXIES": "10.42.0.0/33",
    "LASERBOT_CAMERA_SIZE": "640",
    "LASERBOT_CAMERA_URL": "https://host",
    "LASERBOT_METRICS": "9200",
    "LASERBOT_ARENA": "a.b",
    "LASERBOT_OPERATOR_TOKEN": "secret",
    "LASERBOT_DATABASE": "mysql://u:secret@host/name",
    "ROS_MASTER_URI": "master",
    "ROS_IP": "master",
}


@pytest.mark.parametrize("name", BAD)
def test_each_kind_of_setting_is_checked(name: str) -> None:
    (line,) = wrong(**{name: BAD[name]})
    assert line.startswith(f"{name}")
    assert "secret" not in line.removeprefix(name)


def test_good_and_empty_values_and_those_of_services_are_no_mistakes() -> None:
    services = {f"LASERBOT_MASTER_{name}": "10.0.0.1" for name in ("SERVICE_HOST", "PORT", "PORT_80_TCP_ADDR")}
    assert wrong(LASERBOT_HIT_DAMAGE=" 20\r", LASERBOT_TEAMS="", HOME="/", **services) == []


def test_a_token_and_a_file_with_it_exclude_each_other() -> None:
    (line,) = wrong(LASERBOT_OPERATOR_TOKEN="sixteen letters!", LASERBOT_OPERATOR_TOKEN_FILE="/token")
    assert line.endswith("are both set: choose one")


@pytest.mark.parametrize("name", ["laserbot_hit_damage", "LASERBOTHIT_DAMAGE"])
def test_a_name_that_only_looks_like_a_setting_is_told(name: str) -> None:
    assert wrong(**{name: "20"}) == [f"{name}: there is no such setting; the nearest is LASERBOT_HIT_DAMAGE"]


def test_a_misspelt_secret_is_not_shown() -> None:
    assert "secret" not in "".join(wrong(LASERBOT_OPERATOR_TOKN="secret"))


def test_a_file_is_read_as_compose_reads_it() -> None:
    assert (
        in_file(
            "\ufeff# rules\r\n"
            "LASERBOT_HIT_DAMAGE=20 # a fifth\n"
            "export LASERBOT_COUNTDOWN = '5' # s\n"
            'LASERBOT_ROSTER="raspberrypi1=1 raspberrypi2=2"\n'
            "LASERBOT_WEB_PORT=${PORT}\n"
            "OTHER\n\n"
        )
        == []
    )


def test_what_is_wrong_in_a_file_is_told_with_its_line() -> None:
    assert in_file(
        "LASERBOT_HIT_DAMAGE=20\nLASERBOT_HIT_DAMAGE=lots\nLASERBOT_COUNTDOWN: 5\n"
        "LASERBOT_ROSTER='a=1\nLaserbot_Teams=2\n"
    ) == [
        "line 2: LASERBOT_HIT_DAMAGE: is set before, too, in line 1",
        "line 3: LASERBOT_COUNTDOWN: must be LASERBOT_COUNTDOWN=value",
        "line 4: LASERBOT_ROSTER: its quotes do not end, or something comes after them",
        "line 5: Laserbot_Teams: there is no such setting; the nearest is LASERBOT_TEAMS",
        "line 2: LASERBOT_HIT_DAMAGE=lots: must be a whole number from 1 to 100",
    ]


MANIFESTS = """
apiVersion: v1
kind: List
items:
  - apiVersion: v1
    kind: ConfigMap
    metadata: {name: settings-1, namespace: red}
    data: {LASERBOT_HIT_DAMAGE: lots, LASERBOT_LIGHT: coded}
  - apiVersion: v1
    kind: ConfigMap
    metadata: {name: unread, namespace: red}
    data: {LASERBOT_TEAMS: "7", web: "30500"}
---
apiVersion: v1
kind: Secret
metadata: {name: operator, namespace: red}
data: {token: c2hvcnQ=}
---
apiVersion: apps/v1
kind: Deployment
metadata: {name: master, namespace: red}
spec:
  template:
    spec:
      initContainers: [{name: first, env: [{name: LASERBOT_WEB_PORT, value: 65536}]}]
      containers:
        - name: web
          envFrom: [{configMapRef: {name: settings-1}}]
          env:
            - {name: LASERBOT_OPERATOR_TOKEN, valueFrom: {secretKeyRef: {name: operator, key: token}}}
            - {name: LASERBOT_LIGHT, value: red}
            - {name: LASERBOT_LOG_LEVEL, value: $(LASERBOT_LIGHT)}
            - {name: LASERBOT_RELAY_PORT, value: $(MASTER_SERVICE_PORT_RELAY)}
            - {name: ROS_IP, valueFrom: {fieldRef: {fieldPath: status.podIP}}}
---
apiVersion: batch/v1
kind: CronJob
metadata: {name: nightly, namespace: red}
spec:
  jobTemplate: {spec: {template: {spec: {containers: [{name: backup, env: [{name: LASERBOT_DATBASE, value: x}]}]}}}}
"""


def test_manifests_are_read_as_a_cluster_reads_them() -> None:
    assert sorted(in_file(MANIFESTS)) == [
        "ConfigMap red/settings-1: LASERBOT_HIT_DAMAGE=lots: must be a whole number from 1 to 100",
        "ConfigMap red/unread: LASERBOT_TEAMS=7: must be 0, 2, 3 or 4",
        "CronJob red/nightly, container backup: "
        "LASERBOT_DATBASE: there is no such setting; the nearest is LASERBOT_DATABASE",
        "Deployment red/master, container first: LASERBOT_WEB_PORT=65536: must be a whole number from 1 to 65535",
        "Deployment red/master, container web: LASERBOT_LIGHT=red: must be one of plain, coded",
        "Deployment red/master, container web: LASERBOT_LOG_LEVEL=red: must be one of debug, info, warning, error",
        "Secret red/operator: LASERBOT_OPERATOR_TOKEN: the token needs at least 16 characters: "
        "make one by openssl rand -hex 16",
    ]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("apiVersion: [", "it is no YAML"),
        ("apiVersion: v1\n---\n- a list\n", "every document needs a kind"),
        ("apiVersion: kustomize.config.k8s.io/v1beta1\nkind: Kustomization\n", "kubectl kustomize FOLDER"),
        ("apiVersion: v1\nkind: Secret\nmetadata: {name: a}\ndata: {b: '*'}\n", "no base64"),
        ("apiVersion: v1\nkind: Pod\nmetadata: a\n", "the metadata of a Pod is not as Kubernetes wants it"),
        ("apiVersion: v1\nkind: ConfigMap\nmetadata: {name: a}\ndata: [b]\n", "ConfigMap a is not as"),
        ("apiVersion: v1\nkind: Deployment\nmetadata: {name: a}\nspec: b\n", "Deployment a is not as"),
        ("apiVersion: v1\nkind: Pod\nmetadata: {name: a}\nspec: {containers: [b]}\n", "Pod a is not as"),
        ("apiVersion: v1\nkind: Pod\nmetadata: {name: a}\nspec: {containers: [{env: [{value: b}]}]}\n", "Pod a is not"),
    ],
)
def test_what_is_no_manifest_is_refused(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        groups_of(text)


def test_objects_of_other_projects_are_left_alone() -> None:
    """Their fields may have the names of a pod's."""
    theirs = "apiVersion: example/v1\nkind: Chart\nspec: {template: text, containers: 3}\n"
    assert in_file(theirs) == []
    assert in_file(f"{theirs}---{MANIFESTS}") == in_file(MANIFESTS)


def test_without_what_reads_yaml_manifests_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "yaml.py").write_text("raise ModuleNotFoundError('No module named yaml')")
    path = f"{tmp_path}:{ROOT / 'build/python'}"
    told = run("-", given=MANIFESTS, PYTHONPATH=path)
    assert told.returncode == 2
    assert told.stderr == "laser_bot_battle.check: - cannot be read: PyYAML is missing: apt-get install python3-yaml\n"
    assert run(LASERBOT_TEAMS="2", PYTHONPATH=path).returncode == 0


FLOOR = '{"width": 2, "height": 2, "starts": [[0.3, 0.3], [0.35, 0.3], [9, 1]]}'
NO_FLOOR = [
    "starts[2]: x: must be a number from 0 to 2",
    "starts[1]: two robots do not fit here and at starts[0]",
]


@pytest.mark.parametrize(
    ("text", "problems"),
    [
        (FLOOR, NO_FLOOR),
        ("walls", ["line 1, column 1: is no JSON: Expecting value"]),
        (None, ["cannot be read: No such file or directory"]),
    ],
)
def test_the_environments_floor_is_read(text: str | None, problems: list[str], tmp_path: Path) -> None:
    floor = tmp_path / "hall.json"
    if text is not None:
        floor.write_text(text)
    told = run(LASERBOT_FLOOR=str(floor))
    assert (told.returncode, told.stdout.splitlines()) == (1, [f"LASERBOT_FLOOR={floor}: {each}" for each in problems])


def test_a_wrong_name_of_a_floor_is_told_once() -> None:
    (line,) = run(LASERBOT_FLOOR="batle").stdout.splitlines()
    assert "LASERBOT_FLOOR=batle: must be battle, duel" in line


def test_the_program_tells_and_ends_as_it_says(tmp_path: Path) -> None:
    right = run(LASERBOT_HIT_DAMAGE="20")
    assert (right.returncode, right.stdout) == (0, "")
    told = run(LASERBOT_HIT_DAMAGE="lots", LASERBOT_TEAMS="7")
    assert told.returncode == 1
    assert len(told.stdout.splitlines()) == 2
    (tmp_path / ".env").write_text("LASERBOT_TEAMS=2\n")
    assert run(str(tmp_path / ".env"), LASERBOT_HIT_DAMAGE="lots").returncode == 0
    assert run("-", given=MANIFESTS).returncode == 1
    missing = run(str(tmp_path / "missing"))
    assert (missing.returncode, missing.stdout) == (2, "")
    assert len(missing.stderr.splitlines()) == 1
    assert run("-", given="apiVersion: [").returncode == 2
    assert run("one", "two").returncode == 2
    assert "exit code" in run("--help").stdout
