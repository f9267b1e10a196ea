"""`ci/audit`: findings fail it, unless they are accepted with a reason; so does a database that nobody could ask."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.support.programs import ROOT

BOM = {
    "bomFormat": "CycloneDX",
    "specVersion": "1.6",
    "version": 1,
    "metadata": {"component": {"type": "operating-system", "bom-ref": "it", "name": "webserver", "version": "1"}},
    "components": [
        {
            "type": "library",
            "bom-ref": f"pkg:deb/debian/{name}@{version}?arch=source",
            "purl": f"pkg:deb/debian/{name}@{version}?arch=source",
            "name": name,
            "version": version,
        }
        for name, version in (("openssl", "3.5.1-1"), ("dash", "0.5.12-12"), ("golang-1.24", "1.24.1-1"))
    ],
    "dependencies": [],
}
TRACKER = {
    "openssl": {
        identifier: {"description": "", "releases": {"trixie": {"urgency": "low", "repositories": {}, **state}}}
        for identifier, state in {
            "CVE-2026-0001": {"status": "resolved", "fixed_version": "3.5.4-1~deb13u1"},
            "CVE-2026-0002": {"status": "resolved", "fixed_version": "3.5.0-1"},
            "CVE-2026-0003": {"status": "open"},
        }.items()
    },
    "golang-1.24": {
        "CVE-2026-0004": {
            "description": "",
            "releases": {
                "trixie": {"urgency": "low", "repositories": {}, "status": "resolved", "fixed_version": "1.24.9-1"}
            },
        }
    },
}
# golang-1.24 is only linked into one of them
LOCK = """\
# snapshot 20261126T022231Z
amd64 pool/main/d/dash/dash_0.5.12-12_amd64.deb 0 1
amd64 pool/updates/main/o/openssl/libssl3t64_3.5.1-1_amd64.deb 0 1
"""
NPM = {"vulnerabilities": {"ws": {"name": "ws", "via": [{"url": "https://github.com/advisories/GHSA-aaaa"}, "x"]}}}
PIP = {"dependencies": [{"name": "flask", "version": "1", "vulns": [{"id": "PYSEC-2026-1", "fix_versions": ["2"]}]}]}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project with one old package of each kind, and tools that know it; Debian's is the real one."""
    for folder in ("ci", "images", "build/sbom", ".venv/bin", ".venv/lib/python3.11/site-packages"):
        (tmp_path / folder).mkdir(parents=True)
    shutil.copy(ROOT / "ci/audit", tmp_path / "ci")
    accept(tmp_path)
    (tmp_path / "images/webserver.lock").write_text(LOCK)
    (tmp_path / "build/sbom/webserver.cdx.json").write_text(json.dumps(BOM))
    (tmp_path / "tracker.json").write_text(json.dumps(TRACKER))
    (tmp_path / ".venv/bin/debsbom").symlink_to(ROOT / ".venv/bin/debsbom")
    says(tmp_path, "npm", NPM)
    says(tmp_path, "pip-audit", PIP)
    archive(tmp_path, "nginx 1.26.3-3+deb13u10 -> 1.26.3-3+deb13u11 (security update): webserver", code=1)
    return tmp_path


def archive(project: Path, answer: str, *, code: int) -> None:
    """What comes of the question for newer packages."""
    path = project / "ci/images-lock"
    path.write_text(f"#!/bin/sh\necho '{answer}'{' >&2' if code == 2 else ''}\nexit {code}\n")
    path.chmod(0o755)


def says(project: Path, tool: str, answer: object) -> None:
    path = project / ".venv/bin" / tool
    path.write_text(f"#!/bin/sh\ncat <<'END'\n{json.dumps(answer)}\nEND\n")
    path.chmod(0o755)


def accept(project: Path, *lines: str) -> None:
    (project / "ci/audit-accepted.txt").write_text("\n".join(["# accepted", *lines]))


def audit(project: Path, data: str = "tracker.json") -> tuple[int, list[str]]:
    environment = {"PATH": os.environ["PATH"], "HOME": str(project)}
    words = ["/usr/bin/python3", str(project / "ci/audit"), "--debian", data]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, (done.stdout + done.stderr).splitlines()


def test_what_is_mended_elsewhere_is_found_and_what_is_accepted_passes(project: Path) -> None:
    code, lines = audit(project)
    assert code == 1
    assert "Python: PYSEC-2026-1 flask 1" in lines
    assert "page: GHSA-aaaa ws" in lines
    newer = "nginx 1.26.3-3+deb13u10 -> 1.26.3-3+deb13u11 (security update): webserver"
    assert f"Debian's archive: {newer}" in lines
    assert [line for line in lines if "CVE" in line] == ["Debian's tracker: CVE-2026-0001 openssl@3.5.1-1"]
    accept(project, *(f"{one} tests only" for one in ("PYSEC-2026-1", "GHSA-aaaa", "nginx", "CVE-2026-0001", "GONE-1")))
    code, lines = audit(project)
    assert code == 0
    assert "page: GHSA-aaaa ws: accepted, tests only" in lines
    assert lines[-1] == "no longer found, remove from ci/audit-accepted.txt: GONE-1"


def test_a_database_that_cannot_be_asked_is_no_pass(project: Path) -> None:
    says(project, "npm", {"message": "405 Method Not Allowed", "error": {}})
    says(project, "pip-audit", {"dependencies": [{"name": "flask", "skip_reason": "not to be found"}]})
    archive(project, "lock: the archive could not be asked", code=2)
    shutil.rmtree(project / "build/sbom")
    code, lines = audit(project)
    assert code == 2
    assert lines == [
        "Python: NOT CHECKED: not to be found",
        "page: NOT CHECKED: 405 Method Not Allowed",
        "Debian's archive: NOT CHECKED: lock: the archive could not be asked",
        "Debian's tracker: NOT CHECKED: build/sbom is empty: run ci/images",
    ]


def test_a_missing_tool_and_broken_data_are_no_pass(project: Path) -> None:
    (project / ".venv/bin/pip-audit").unlink()
    (project / "tracker.json").write_text("<html>away</html>")
    code, lines = audit(project)
    assert code == 2
    assert any(line.startswith("Python: NOT CHECKED: ") for line in lines)
    assert any(line.startswith("Debian's tracker: NOT CHECKED: ") for line in lines)
