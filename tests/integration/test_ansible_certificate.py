"""roles/master/tasks/tls.yml: the front's certificate, from the fleet's own authority or from the operator."""

import json
import os
import subprocess
from pathlib import Path

import pytest

from tests.support.local_play import play_role, recap

ADDRESS = "192.0.2.10"


class Master:
    """A master's folders of the CA and of the front's certificate."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.ca, self.tls = folder / "ca", folder / "tls"
        self.ca.mkdir()
        make = ["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "3650", "-subj", "/CN=arena"]
        files = ["-keyout", self.ca / "ca.key", "-out", self.ca / "ca.crt"]
        openssl(*make, "-addext", "keyUsage=critical,keyCertSign", *files)

    def deploy(self, tls: object, *flags: str, **more: object) -> int:
        """How many tasks say that they have changed something."""
        run = self.run(tls, *flags, **more)
        row = recap(run.stdout)["laser_bot_master"]
        assert row["failed"] == 0, run.stdout
        return row["changed"]

    def run(self, tls: object, *flags: str, **more: object) -> subprocess.CompletedProcess[str]:
        knobs = {
            "master_tls": tls,
            "fleet_ca": str(self.ca),
            "master_tls_folder": str(self.tls),
            "fleet_container_user": os.getuid(),
            "fleet_master_address": ADDRESS,
            **more,
        }
        return play_role("master", "tls", json.dumps(knobs), self.folder, "laser_bot_master", *flags)

    def files(self) -> dict[str, int]:
        """Those of the certificate, with their modes."""
        return {path.name: path.stat().st_mode & 0o777 for path in self.tls.iterdir()}


def openssl(*arguments: object) -> str:
    run = subprocess.run(["openssl", *map(str, arguments)], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.fixture
def master(tmp_path: Path) -> Master:
    return Master(tmp_path)


@pytest.mark.slow
def test_the_fleets_own_certificate_is_made_once_and_renewed_before_its_end(master: Master) -> None:
    master.deploy("")
    assert master.deploy("own", "--check") > 0
    assert master.files() == {}, "a dry run"
    assert master.deploy("own") > 0
    assert master.files() == {"front.key": 0o400, "front.crt": 0o644, "ca.crt": 0o644}
    names = ("-verify_hostname", "laser-bot-master.local"), ("-verify_ip", ADDRESS)
    for name in names:
        openssl("verify", "-purpose", "sslserver", *name, "-CAfile", master.tls / "ca.crt", master.tls / "front.crt")
    openssl("x509", "-in", master.tls / "front.crt", "-noout", "-checkend", 700 * 86400)
    first = (master.tls / "front.crt").read_text()
    assert master.deploy("own") == 0
    assert (master.tls / "front.crt").read_text() == first
    assert master.deploy("own", master_tls_renewal=900) == 1, "there are only 800 days left"
    assert (master.tls / "front.crt").read_text() != first


@pytest.mark.slow
def test_the_operators_certificate_takes_its_place_and_nothing_is_left_without_one(
    master: Master, tmp_path: Path
) -> None:
    given = tmp_path / "given"
    given.mkdir()
    for name in ("front.crt", "front.key"):
        (given / name).write_text(f"{name} of the operator")
    master.deploy("own")
    assert master.deploy(str(given)) > 0
    assert master.files() == {"front.key": 0o400, "front.crt": 0o400}
    assert (master.tls / "front.key").read_text() == "front.key of the operator"
    assert master.deploy("") > 0
    assert master.files() == {}


@pytest.mark.parametrize(
    "wrong", ["Own", *(pytest.param(wrong, marks=pytest.mark.slow) for wrong in (True, "certificates", "/nowhere"))]
)
def test_a_wrong_setting_is_told_before_anything_is_taken_away(master: Master, wrong: object) -> None:
    master.deploy("own")
    before = master.files()
    run = master.run(wrong)
    assert recap(run.stdout)["laser_bot_master"]["failed"] == 1
    assert f"master_tls is {wrong}: it must be empty, own, or the absolute path" in " ".join(run.stdout.split())
    assert master.files() == before
