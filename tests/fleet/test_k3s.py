"""ansible/k3s.yml asks every node's k3s for the right things, and tells what k3s complains about.

k3s itself is not part of a rehearsal: a stand-in notes what it is asked for.
"""

import base64
import json
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

from fleet import Machine
from tests.support.archive import Archive
from tests.support.imagefile import version
from tests.support.manifests import customized
from tests.support.rehearsal import Rehearsal

pytestmark = pytest.mark.slow

PROGRAM = "/usr/local/bin/k3s"
NOTES = "/var/tmp/k3s"
IMAGES = "/var/lib/rancher/k3s/agent/images/laserbot.tar"
STAND_IN = f"""#!/bin/sh
# what was applied or labelled before is unchanged, as with the real one
echo "$*" >>{NOTES}/calls
again={NOTES}/$(echo "$*" | cksum | cut -d ' ' -f 1)
case "$*" in
"kubectl diff --filename -") [ -e {NOTES}/$(cksum | cut -d ' ' -f 1) ] ;;
"kubectl apply --filename -")
    cat >{NOTES}/given
    known={NOTES}/$(cksum <{NOTES}/given | cut -d ' ' -f 1)
    # of stringData it says so each time
    [ -e $known ] && ! grep -q stringData {NOTES}/given && said=unchanged || said=configured
    echo "thing/one $said"
    mv {NOTES}/given $known
    ;;
*" delete secret operator --ignore-not-found")
    for secret in $(grep -l '"kind": "Secret"' -r {NOTES} --exclude=calls); do
        rm $secret && echo 'secret "operator" deleted'
    done
    ;;
*" delete poddisruptionbudget --ignore-not-found arena master robot")
    [ ! -e {NOTES}/budgets ] || {{ cat {NOTES}/budgets; rm {NOTES}/budgets; }} ;;
*" get secret operator "*) grep -l '"kind": "Secret"' -r {NOTES} --exclude=calls | xargs -r ls -t | head -n 1 ;;
*" patch deployment master "*)
    echo "$*" >{NOTES}/given
    cmp -s {NOTES}/given {NOTES}/master && same=' (no change)' || same=
    echo "deployment.apps/master patched$same"
    mv {NOTES}/given {NOTES}/master
    ;;
"ctr images import "*) [ ! -e {NOTES}/full ] || {{ echo "no space left on device" >&2; exit 1; }}
    tar -xOf "$4" index.json >{NOTES}/imported ;;
"ctr images list") cat {NOTES}/imported || true ;;
"kubectl label "*) [ -e $again ] && echo "node/one not labeled" || echo "node/one labeled"; touch $again ;;
"kubectl get deployments,"*) cat {NOTES}/pods ;;
"kubectl get nodes "*) cat {NOTES}/nodes || true ;;
*" get daemonset "*) echo "$(cat {NOTES}/robots || echo 1,1,2,2,2)" ;;
"kubectl get pods "*) echo "robot-x7k2p 0/1 ErrImageNeverPull" ;;
*" rollout status "*) [ ! -e {NOTES}/stuck ] || {{ echo "timed out waiting for the condition" >&2; exit 1; }} ;;
esac
"""


@pytest.fixture
def images(tmp_path: Path) -> Archive:
    return Archive(tmp_path / "images.tar")


@pytest.fixture
def archive(images: Archive) -> Path:
    return images.path


def running(images: Archive) -> str:
    """A master's pod with an archive's image, as kubectl gives it."""
    image = {"name": "web", "imageID": images.settings["webserver", "amd64"]}
    pod = {
        "metadata": {"namespace": "laserbot", "name": "master-1"},
        "spec": {"containers": [{"name": "web", "image": "webserver"}]},
        "status": {"phase": "Running", "containerStatuses": [image]},
    }
    return json.dumps({"items": [pod]})


@pytest.fixture
def nodes(rehearsal: Rehearsal, images: Archive) -> Iterator[list[Machine]]:
    """All hosts, with a k3s."""
    machines = list(rehearsal.machines.values())
    for machine in machines:
        install = (
            f"mkdir {NOTES} && printf %s {shlex.quote(STAND_IN)} >{PROGRAM} && chmod 755 {PROGRAM}"
            f" && printf %s {shlex.quote(running(images))} >{NOTES}/pods"
        )
        machine.run(f"sh -c {shlex.quote(install)}")
    yield machines
    for machine in machines:
        machine.run(f"rm -rf {NOTES} {PROGRAM} /var/lib/rancher")


def calls(machine: Machine) -> list[str]:
    return machine.run(f"cat {NOTES}/calls").splitlines()


def applied(machine: Machine) -> list[dict[str, object]]:
    """The objects that k3s was given."""
    texts = machine.run(f"grep -l apiVersion -r {NOTES} --exclude=calls").split()
    documents = (document for text in texts for document in yaml.safe_load_all(machine.run(f"cat {text}")))
    return [document for document in documents if document]


def patch(machine: Machine) -> dict[str, object]:
    """The annotations that the master's pods were given last."""
    words = machine.run(f"cat {NOTES}/master").split(" --patch ", 1)
    return dict(json.loads(words[1])["spec"]["template"]["metadata"]["annotations"])


def by_name(objects: list[dict[str, object]]) -> dict[tuple[object, object], object]:
    return {(one["kind"], dict(one["metadata"])["name"]): one for one in objects}  # type: ignore[call-overload]


def test_hosts_without_k3s_are_told_where_to_get_it(rehearsal: Rehearsal, archive: Path) -> None:
    run = rehearsal.playbook("k3s", f"--extra-vars=fleet_images_archive={archive}", check=False)
    assert run.process.returncode != 0
    assert "docs/kubernetes-robots.md" in run.output


def test_the_nodes_get_images_labels_and_the_game(
    rehearsal: Rehearsal, nodes: list[Machine], images: Archive, archive: Path, tmp_path: Path
) -> None:
    variables = f"--extra-vars=fleet_images_archive={archive}"
    nodes[1].run(f"touch {NOTES}/full")
    assert rehearsal.playbook("k3s", variables, check=False).recap[nodes[1].name]["failed"] == 1
    nodes[1].run(f"rm {NOTES}/full")
    run = rehearsal.playbook("k3s", variables)
    assert run.recap[nodes[1].name]["changed"] == 1, "the import is tried again"
    for node in nodes:
        assert node.host.file(IMAGES).size == archive.stat().st_size
        assert f"ctr images import {IMAGES}" in " ".join(calls(node))
    labels = {tuple(call.split()[3:5]) for call in calls(nodes[0]) if call.startswith("kubectl label node")}
    roles = {"master": "master", "robots": "robot"}
    assert labels == {(node.run("hostname").strip(), f"laserbot/role={roles[node.group]}") for node in nodes}

    by_digest = [
        {"name": name, "newTag": f"{version()}-{digest.replace(':', '-')}"} for name, digest in images.digests.items()
    ]
    wanted = by_name(customized(tmp_path, "lan", images=by_digest).objects)
    given = by_name(applied(nodes[0]))
    token = nodes[0].run("cat /etc/laserbot/operator-token").strip()
    assert given.pop(("Secret", "operator"))["data"] == {"token": base64.b64encode(token.encode()).decode()}  # type: ignore[index]
    wanted.pop(("Secret", "operator"), None)
    assert given == wanted
    assert token not in run.output
    workloads = {f"{str(kind).lower()}/{name}" for kind, name in wanted if kind in ("Deployment", "DaemonSet")}
    waited = {call.split()[5] for call in calls(nodes[0]) if " rollout status " in call}
    assert waited | {"daemonset/robot"} == workloads
    assert [call for call in calls(nodes[0]) if " get daemonset robot " in call]

    again = rehearsal.playbook("k3s", variables)
    assert again.changed == 0, again.output


def test_images_of_a_registry_are_named_by_digest_too(
    rehearsal: Rehearsal, nodes: list[Machine], images: Archive, archive: Path, tmp_path: Path
) -> None:
    registry = {"name": "registry", "literals": ["address=192.168.1.20:5000"]}
    own = tmp_path / "own"
    own.mkdir()
    customized(own, "lan", "registry", configMapGenerator=[registry])
    rehearsal.playbook("k3s", f"--extra-vars=fleet_images_archive={archive}", f"--extra-vars=k3s_overlay={own}")
    robot = by_name(applied(nodes[0]))["DaemonSet", "robot"]
    (container,) = robot["spec"]["template"]["spec"]["containers"]  # type: ignore[index]
    assert container["image"] == f"192.168.1.20:5000/rosberry@{images.digests['rosberry']}"


def test_a_robot_that_is_off_holds_up_no_other_one(rehearsal: Rehearsal, nodes: list[Machine], archive: Path) -> None:
    """Kubernetes counts it among the robots that may be missing during an update."""
    told = f"printf 'raspberrypi1 True\\nraspberrypi2 Unknown\\n' >{NOTES}/nodes; echo 2,2,2,1,1 >{NOTES}/robots"
    nodes[0].run(f"sh -c {shlex.quote(told)}")
    run = rehearsal.playbook("k3s", f"--extra-vars=fleet_images_archive={archive}")
    assert "Not ready: raspberrypi2." in run.output
    robot = by_name(applied(nodes[0]))["DaemonSet", "robot"]
    assert robot["spec"]["updateStrategy"]["rollingUpdate"] == {"maxUnavailable": 2}  # type: ignore[index]


def test_the_master_has_the_token_that_there_is(rehearsal: Rehearsal, nodes: list[Machine], archive: Path) -> None:
    variables = f"--extra-vars=fleet_images_archive={archive}"
    rehearsal.playbook("k3s", variables)
    first = patch(nodes[0])
    assert first["laserbot/token"]

    nodes[0].run(f"rm {NOTES}/master")  # as after a run that was broken off before it
    assert rehearsal.playbook("k3s", variables).recap[nodes[0].name]["changed"] == 1
    assert patch(nodes[0]) == first

    run = rehearsal.playbook("k3s", variables, "--extra-vars=fleet_operator_token=another-token-of-sixteen")
    assert run.recap[nodes[0].name]["changed"] == 2, run.output
    assert patch(nodes[0])["laserbot/token"] not in (None, first["laserbot/token"])


def test_a_token_that_is_taken_away_is_no_longer_valid(
    rehearsal: Rehearsal, nodes: list[Machine], archive: Path
) -> None:
    variables = f"--extra-vars=fleet_images_archive={archive}"
    rehearsal.playbook("k3s", variables)
    assert ("Secret", "operator") in by_name(applied(nodes[0]))

    run = rehearsal.playbook("k3s", variables, "--extra-vars=fleet_operator_token=")
    assert ("Secret", "operator") not in by_name(applied(nodes[0]))
    assert patch(nodes[0]) == {"laserbot/token": None}
    assert run.recap[nodes[0].name]["changed"] == 2, run.output

    again = rehearsal.playbook("k3s", variables, "--extra-vars=fleet_operator_token=")
    assert again.changed == 0, again.output


def test_budgets_of_earlier_versions_go(rehearsal: Rehearsal, nodes: list[Machine], archive: Path) -> None:
    variables = f"--extra-vars=fleet_images_archive={archive}"
    rehearsal.playbook("k3s", variables)
    told = f"echo 'poddisruptionbudget.policy \"master\" deleted' >{NOTES}/budgets"
    nodes[0].run(f"sh -c {shlex.quote(told)}")
    assert rehearsal.playbook("k3s", variables).recap[nodes[0].name]["changed"] == 1
    assert rehearsal.playbook("k3s", variables).changed == 0


def test_what_runs_is_compared_with_what_was_built(
    rehearsal: Rehearsal, nodes: list[Machine], archive: Path, tmp_path: Path
) -> None:
    older = running(Archive(tmp_path / "older.tar", {"webserver": "older"}))
    nodes[0].run(f"sh -c {shlex.quote(f'printf %s {shlex.quote(older)} >{NOTES}/pods')}")
    run = rehearsal.playbook("k3s", f"--extra-vars=fleet_images_archive={archive}", check=False)
    assert run.process.returncode != 0
    assert "laserbot/master-1 web: runs sha256:" in run.output


def test_an_archive_without_digests_changes_nothing(rehearsal: Rehearsal, nodes: list[Machine], tmp_path: Path) -> None:
    plain = Archive(tmp_path / "plain.tar", by_digest=False).path
    run = rehearsal.playbook("k3s", f"--extra-vars=fleet_images_archive={plain}", check=False)
    assert run.process.returncode != 0
    assert "by digest; write it anew" in run.output
    assert not [call for call in calls(nodes[0]) if call.startswith(("kubectl apply", "ctr images import"))]


def test_pods_that_do_not_become_ready_are_shown(rehearsal: Rehearsal, nodes: list[Machine], archive: Path) -> None:
    nodes[0].run(f"touch {NOTES}/stuck")
    run = rehearsal.playbook("k3s", f"--extra-vars=fleet_images_archive={archive}", check=False)
    assert run.process.returncode != 0
    assert "ErrImageNeverPull" in run.output
    assert "docs/kubernetes-cures.md" in run.output
