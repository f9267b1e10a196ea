"""components/backups and components/leaderboard-backups: the store's own program, each night and by hand."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from sqlalchemy import URL

from server.store import versions
from server.store.database import make_engine
from tests.k3s.conftest import Customize
from tests.k3s.test_overlays import validate
from tests.k3s.test_rights import is_restricted
from tests.support.documents import page
from tests.support.imagefile import dockerfile, version
from tests.support.manifests import Kubelet, Manifests, Object, overlay
from tests.support.program_settings import ProgramSettings
from tests.support.programs import ROOT

WITH_FILE = ("lan", "sim+kept-data+backups")
WITH_SERVER = "arenas+leaderboard+leaderboard-backups"
BOTH = pytest.mark.parametrize("name", [*WITH_FILE, WITH_SERVER])
FOLDER = "/var/backups/laserbot"


def pod_of(manifests: Manifests, job: str) -> Object:
    pod: Object = manifests.one("CronJob", job)["spec"]["jobTemplate"]["spec"]["template"]["spec"]
    return pod


def started(manifests: Manifests, job: str, **changed: str) -> tuple[list[str], dict[str, str]]:
    """Command and environment of the job's container; `changed` are variables that whoever makes the Job sets."""
    pod = pod_of(manifests, job)
    (container,) = pod["containers"]
    asked = [
        {**each, "value": changed[each["name"]]} if each["name"] in changed else each
        for each in container.get("env", [])
    ]
    container = {**container, "env": asked}
    namespace = manifests.one("CronJob", job)["metadata"]["namespace"]
    services = {item["metadata"]["name"]: "10.43.0.54" for item in manifests.within(namespace).of("Service")}
    kubelet = Kubelet(manifests.within(namespace), pod, {}, services)
    return kubelet.command(container), kubelet.environment(container)


@BOTH
def test_it_fits_the_schemas_and_has_no_rights(name: str) -> None:
    manifests = overlay(name)
    validate(manifests, "1.32")
    for job in ("backup", "restore"):
        pod = pod_of(manifests, job)
        assert is_restricted(pod)
        assert pod["automountServiceAccountToken"] is False
        assert pod["restartPolicy"] == "Never"
        (container,) = pod["containers"]
        assert container["image"] == f"webserver:{version()}"
        assert {mount["name"] for mount in container["volumeMounts"]} == {volume["name"] for volume in pod["volumes"]}
        rights = pod["securityContext"]
        assert f"{rights['runAsUser']}:{rights['runAsGroup']}" == dockerfile("webserver").user


@BOTH
def test_one_is_made_each_night_and_none_is_put_back_by_itself(name: str) -> None:
    backup, restore = (overlay(name).one("CronJob", job)["spec"] for job in ("backup", "restore"))
    assert backup["schedule"] == "0 4 * * *"
    assert not backup.get("suspend")
    assert restore["suspend"] is True
    assert restore["jobTemplate"]["spec"]["backoffLimit"] == 0, "a second time would put the first one's aside"
    assert {each["concurrencyPolicy"] for each in (backup, restore)} == {"Forbid"}


@BOTH
def test_backups_outlive_their_pod(name: str) -> None:
    manifests = overlay(name)
    claim = manifests.one("PersistentVolumeClaim", "backups")
    for job in ("backup", "restore"):
        assert manifests.one("CronJob", job)["metadata"]["namespace"] == claim["metadata"]["namespace"]
        pod = pod_of(manifests, job)
        (volume,) = [
            each["name"] for each in pod["volumes"] if each.get("persistentVolumeClaim") == {"claimName": "backups"}
        ]
        assert {"name": volume, "mountPath": FOLDER} in pod["containers"][0]["volumeMounts"]


@pytest.mark.parametrize("name", WITH_FILE)
def test_it_has_the_masters_database_on_the_masters_node(name: str) -> None:
    manifests = overlay(name)
    master = manifests.one("Deployment", "master")["spec"]["template"]
    (data,) = [volume for volume in master["spec"]["volumes"] if volume["name"] == "data"]
    for job in ("backup", "restore"):
        pod = pod_of(manifests, job)
        assert data in pod["volumes"]
        mount = {"name": "data", "mountPath": dockerfile("webserver").environment["LASERBOT_DATA"]}
        assert mount in pod["containers"][0]["volumeMounts"]
    (term,) = pod_of(manifests, "backup")["affinity"]["podAffinity"]["requiredDuringSchedulingIgnoredDuringExecution"]
    assert term["topologyKey"] == "kubernetes.io/hostname"
    assert term["labelSelector"]["matchLabels"].items() <= master["metadata"]["labels"].items()
    assert "podAffinity" not in pod_of(manifests, "restore")["affinity"], "the master is stopped"
    tolerated = {each["key"] for each in master["spec"].get("tolerations", []) if each["effect"] == "NoSchedule"}
    assert tolerated <= {each["key"] for each in pod_of(manifests, "backup")["tolerations"]}


def test_it_has_the_database_of_all_arenas() -> None:
    manifests = overlay(WITH_SERVER)
    pod = manifests.within("laserbot-red").one("Deployment", "master")["spec"]["template"]["spec"]
    (web,) = [each for each in pod["containers"] if each["name"] == "web"]
    fields = {"metadata.namespace": "laserbot-red", "status.podIP": "10.42.0.7"}
    kubelet = Kubelet(manifests.within("laserbot-red"), pod, fields, {})
    settings = ProgramSettings(kubelet.command(web), kubelet.environment(web)).settings
    assert settings is not None
    for job in ("backup", "restore"):
        assert ProgramSettings(*started(manifests, job)).settings == (settings.database, 14)


@BOTH
def test_the_program_reads_what_it_is_given(name: str) -> None:
    for job in ("backup", "restore"):
        command, environment = started(overlay(name), job)
        read = ProgramSettings(command, environment).variables
        own = {each for each in environment if each.startswith("LASERBOT_")}
        assert own <= read


def test_what_was_saved_comes_back(tmp_path: Path) -> None:
    """The commands of both Jobs, as the kubelet starts them, in folders of this machine."""
    (tmp_path / "backups").mkdir()
    database = tmp_path / "laserbot.db"
    engine = make_engine(URL.create("sqlite", database=str(database)))
    with engine.begin() as connection:
        versions.prepare(connection)
    engine.dispose()

    def run(job: str, **changed: str) -> str:
        command, environment = started(overlay("lan"), job, **changed)
        words = [word.replace(FOLDER, str(tmp_path / "backups")) for word in command[1:]]
        path = {"PATH": os.environ["PATH"], "PYTHONPATH": f"{ROOT}:{ROOT / 'build/python'}"}
        done = subprocess.run(
            [sys.executable, *words],
            env={**path, **environment, "LASERBOT_DATA": str(tmp_path)},
            capture_output=True,
            text=True,
            timeout=60,
            check=True,
        )
        return done.stderr

    run("backup")
    (saved,) = (tmp_path / "backups").glob("laserbot-*.db")
    older = saved.rename(saved.with_name("laserbot-2001-01-01T040000Z.db"))
    run("backup")
    (newest,) = set((tmp_path / "backups").glob("laserbot-*.db")) - {older}
    assert f"is as in {newest};" in run("restore")
    assert f"is as in {older};" in run("restore", BACKUP=older.name)


def test_how_many_stay_is_one_value(customize: Customize) -> None:
    generator = {"name": "backups", "namespace": "laserbot", "behavior": "merge", "literals": ["LASERBOT_BACKUPS=30"]}
    command, environment = started(customize("lan", configMapGenerator=[generator]), "backup")
    assert ProgramSettings(command, environment).settings[1] == 30


def test_their_images_come_from_the_registry_too(customize: Customize) -> None:
    registry = {"name": "registry", "literals": ["address=registry.example"]}
    changed = customize("lan", "registry", configMapGenerator=[registry])
    for job in ("backup", "restore"):
        assert pod_of(changed, job)["containers"][0]["image"] == f"registry.example/webserver:{version()}"


POSTGRESQL = page("postgresql.md")


def test_the_page_on_postgresql_names_what_is_there(customize: Customize) -> None:
    manifests = overlay(WITH_SERVER)
    names = {(item["kind"].lower(), item["metadata"]["name"]) for item in manifests.objects}
    namespaces = set(re.findall(r"kubectl -n (\S+)", POSTGRESQL))
    assert namespaces == set(manifests.namespaces)
    for kind, name in re.findall(r"(?:--from=|\s)(cronjob|statefulset|deployment)/([a-z]+)", POSTGRESQL):
        assert (kind, name) in names
    (postgres,) = manifests.one("StatefulSet", "leaderboard")["spec"]["template"]["spec"]["containers"]
    changes = re.findall(r"laserbot-leaderboard (scale|set env|set image) statefulset/leaderboard (\S+)", POSTGRESQL)
    assert [words for words, _ in changes] == ["scale", "set env", "set image", "scale"], "17 must not begin the folder"
    assert changes[2][1].startswith(f"{postgres['name']}=")
    example = yaml.safe_load(re.findall(r"```yaml\n(.*?)```", POSTGRESQL, re.DOTALL)[1])
    changed = customize("arenas", "leaderboard", "leaderboard-backups", **example)
    (after,) = changed.one("StatefulSet", "leaderboard")["spec"]["template"]["spec"]["containers"]
    assert after["image"] == "postgres:18"
    folder, old = ({each["name"]: each.get("value") for each in one["env"]}["PGDATA"] for one in (after, postgres))
    assert f"PGDATA={folder}" in POSTGRESQL
    assert f"rm -r {old}`" in POSTGRESQL
    mounts = [mount["mountPath"] for mount in after["volumeMounts"] if mount["name"] == "data"]
    assert mounts == [str(Path(folder).parent)] == [str(Path(old).parent)], "both have room on the volume"
    assert len(after["env"]) == len(postgres["env"])
