"""A fleet that has been deployed once: nothing is left to do, and it passes the operator's checks."""

import shlex
from collections.abc import Iterator

import pytest

from fleet import Machine
from tests.support.programs import ROOT
from tests.support.rehearsal import Rehearsal

# A package in version 1, and an archive of security updates that has version 2.
UPDATE = r"""
set -e
mkdir -p /srv/security/package/DEBIAN
cd /srv/security
for version in 1 2; do
    printf '%s\n' 'Package: laserbot-old' "Version: $version" 'Architecture: all' >package/DEBIAN/control
    printf '%s\n' 'Maintainer: x <x@x>' 'Description: x' >>package/DEBIAN/control
    dpkg-deb --build package old_$version.deb
done
dpkg --install old_1.deb
{
    cat package/DEBIAN/control
    printf '%s\n' 'Filename: ./old_2.deb' "Size: $(stat -c %s old_2.deb)"
    echo "SHA256: $(sha256sum old_2.deb | cut -d ' ' -f 1)"
} >Packages
printf '%s\n' 'Origin: Debian' 'Label: Debian-Security' 'SHA256:' \
    " $(sha256sum Packages | cut -d ' ' -f 1) $(stat -c %s Packages) Packages" >Release
echo 'deb [trusted=yes] file:/srv/security ./' >/etc/apt/sources.list.d/security.list
apt-get update
"""
FORGET = """
apt-get purge -y laserbot-old
rm -rf /srv/security /etc/apt/sources.list.d/security.list
apt-get update
"""


@pytest.fixture
def outdated(rehearsal: Rehearsal) -> Iterator[Machine]:
    """A robot with an open security update."""
    robot = rehearsal.machines["raspberrypi1"]
    robot.run(f"sh -c {shlex.quote(UPDATE)}")
    yield robot
    robot.run(f"sh -c {shlex.quote(FORGET)}")


@pytest.mark.slow
def test_an_open_security_update_is_told_and_then_installed(rehearsal: Rehearsal, outdated: Machine) -> None:
    told = rehearsal.playbook("check", f"--limit={outdated.name}").output
    assert f"{outdated.name}: open security updates: laserbot-old" in told
    outdated.run("unattended-upgrade")
    assert outdated.run("dpkg-query --show --showformat '${Version}' laserbot-old") == "2"
    told = rehearsal.playbook("check", f"--limit={outdated.name}").output
    assert "open security updates" not in told


def test_a_second_deploy_changes_nothing(rehearsal: Rehearsal) -> None:
    run = rehearsal.playbook("deploy")
    print(f"second run: {run.seconds:.0f} s")
    assert run.changed == 0, run.output
    assert set(run.recap) == set(rehearsal.machines)
    assert max(row["ok"] for row in run.recap.values()) <= 70, "tasks: most of them take a second"


def test_the_operators_checks_pass(rehearsal: Rehearsal) -> None:
    """All of ansible/checks, on every host, as a table."""
    run = rehearsal.playbook("check")
    rows = [line for line in run.output.splitlines() if " ok " in line]
    assert len(rows) > 15, run.output
    assert not any("FAILED" in row for row in rows)
    assert not (ROOT / "build" / "fleet-hosts.json").exists(), "what the checks were told"
