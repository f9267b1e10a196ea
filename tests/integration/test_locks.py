"""images/fetch, images/solve and ci/images-lock: locked packages still come when Debian's archive has moved on."""

import hashlib
import os
import shutil
import subprocess
import time
from collections import Counter
from collections.abc import Iterator
from email.utils import formatdate
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest

from tests.support.programs import ROOT

SNAPSHOT = "20261126T022231Z"
NAMES = ("alpha", "beta", "gamma", "delta")
GONE = {"alpha", "beta", "gamma"}


class Archive:
    """Debian's archive, its security updates and its snapshots, on a port of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.asked: Counter[str] = Counter()
        self.has_snapshots, self.pause, self.busy, self.wrong = True, 0.0, 0, False
        self.breaks_off = ""  # in the middle of what is below that address
        self.dates: dict[str, float] = {}
        archive = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                archive.answer(self)

            def log_message(self, *_: object) -> None:
                pass

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self._server.server_port}"
        Thread(target=self._server.serve_forever, daemon=True).start()

    def close(self) -> None:
        self._server.shutdown()
        self._server.server_close()

    def answer(self, request: BaseHTTPRequestHandler) -> None:
        self.asked[request.path] += 1
        path = self.folder / request.path.lstrip("/")
        content = path.read_bytes() if path.is_file() else None
        if request.path.startswith("/snapshot/"):
            if not self.has_snapshots:
                content = None
            elif self.busy:
                self.busy -= 1
                request.send_error(429)
                return
            elif self.wrong and content is not None:
                content = b"x" * len(content)
            time.sleep(self.pause)
        if content is None:
            request.send_error(404)
            return
        request.send_response(200)
        request.send_header("Content-Length", str(len(content)))
        request.end_headers()
        if self.breaks_off and request.path.startswith(self.breaks_off):
            content = content[: len(content) // 2]
        request.wfile.write(content)

    def add(self, name: str, version: str, *, place: str = "debian", suite: str = "trixie") -> str:
        """A package, in a suite and its archive's snapshot; its line of a lock, without the architecture."""
        root = self.folder / "deb"
        (root / "DEBIAN").mkdir(parents=True)
        control = f"Package: {name}\nVersion: {version}\nArchitecture: all\nMaintainer: x <x@x>\nDescription: x\n"
        (root / "DEBIAN/control").write_text(control)
        pool = f"pool/{'updates/' if place == 'debian-security' else ''}main/{name[0]}/{name}/{name}_{version}_all.deb"
        for base in (self.folder / place, self.folder / "snapshot" / place / SNAPSHOT):
            (base / pool).parent.mkdir(parents=True, exist_ok=True)
        deb = self.folder / place / pool
        subprocess.run(["dpkg-deb", "--build", "--root-owner-group", root, deb], check=True, capture_output=True)
        shutil.copyfile(deb, self.folder / "snapshot" / place / SNAPSHOT / pool)
        shutil.rmtree(root)
        content = deb.read_bytes()
        digest = hashlib.sha256(content).hexdigest()
        with (self.folder / f"{suite}.packages").open("a") as file:
            file.write(f"{control}Filename: {pool}\nSize: {len(content)}\nSHA256: {digest}\n\n")
        return f"{pool} {digest} {len(content)}"

    def publish(self, later: int = 0) -> None:
        """Its lists, as of a day before the snapshot, or so many seconds later."""
        date = formatdate(1795573351 + later, usegmt=True)
        for place, suite in (
            ("debian", "trixie"),
            ("debian", "trixie-updates"),
            ("debian-security", "trixie-security"),
        ):
            listed = self.folder / f"{suite}.packages"
            content = listed.read_bytes() if listed.exists() else b""
            folder = self.folder / place / "dists" / suite
            release = f"Origin: Debian\nSuite: {suite}\nCodename: {suite}\nDate: {date}\nSHA256:\n"
            for architecture in ("amd64", "arm64"):
                name = f"main/binary-{architecture}/Packages"
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / name).write_bytes(content)
                release += f" {hashlib.sha256(content).hexdigest()} {len(content)} {name}\n"
            (folder / "Release").write_text(release)


@pytest.fixture
def archive(tmp_path: Path) -> Iterator[Archive]:
    folder = tmp_path / "archive"
    folder.mkdir()
    made = Archive(folder)
    yield made
    made.close()


class Project:
    """The scripts, and a lock of four packages, of which the archive has lost three."""

    def __init__(self, folder: Path, archive: Archive) -> None:
        self.folder, self.archive = folder, archive
        for name in ("ci/mirror", "ci/images-lock", "images/fetch", "images/solve"):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
        (folder / "images/tools.packages").write_text("\n".join(NAMES))
        # the archive of the test is not signed, and does not recover while apt waits
        (folder / "apt.conf").write_text(
            'Acquire::AllowInsecureRepositories "true";\nAcquire::Retries::Delay "false";\n'
        )
        self.lock = folder / "images/tools.lock"

    def run(self, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
        environment = {
            **os.environ,
            "APT_CONFIG": str(self.folder / "apt.conf"),
            "DEBIAN_MIRROR": f"{self.archive.url}/debian",
            "DEBIAN_SNAPSHOT": f"{self.archive.url}/snapshot",
            **variables,
        }
        return subprocess.run(
            words, cwd=self.folder, env=environment, capture_output=True, text=True, timeout=120, check=False
        )

    def fetch(self, **variables: str) -> subprocess.CompletedProcess[str]:
        return self.run("images/fetch", "build/packages", "tools/amd64", **variables)

    def laid_out(self) -> list[str]:
        return sorted(path.name for path in (self.folder / "build/packages/tools/amd64").glob("*"))


OLD = sorted(f"{name}_1_all.deb" for name in NAMES)
TODAY = sorted(f"{name}_{2 if name in GONE else 1}_all.deb" for name in NAMES)


@pytest.fixture
def project(tmp_path: Path, archive: Archive) -> Project:
    made = Project(tmp_path / "project", archive)
    lines = [
        archive.add(name, "1", **({"place": "debian-security"} if name == "gamma" else {}), suite="old")
        for name in sorted(GONE)
    ]
    lines.append(archive.add("delta", "1"))
    made.lock.write_text("\n".join([f"# snapshot {SNAPSHOT}", *(f"amd64 {line}" for line in lines), ""]))
    for line in lines[:3]:
        for place in ("debian", "debian-security"):
            (archive.folder / place / line.split()[0]).unlink(missing_ok=True)
    archive.add("alpha", "2")
    archive.add("beta", "2", suite="trixie-updates")
    archive.add("gamma", "2", place="debian-security", suite="trixie-security")
    archive.publish()
    return made


@pytest.mark.parametrize("trouble", [{}, {"pause": 0.5}, {"busy": 1}], ids=["quick", "slow", "busy"])
def test_what_the_archive_has_lost_comes_from_its_snapshots(project: Project, trouble: dict[str, float]) -> None:
    vars(project.archive).update(trouble)
    done = project.fetch(LOCKED="1")
    assert done.returncode == 0, done.stderr
    assert "3 cannot be had from the archive: asking its snapshots" in done.stderr
    assert project.laid_out() == OLD
    assert not any("delta" in path for path in project.archive.asked if path.startswith("/snapshot/"))
    project.archive.asked.clear()
    assert project.fetch().returncode == 0
    assert not project.archive.asked, "what is here is not asked for again"


@pytest.mark.parametrize(("breaks_off", "code"), [("/debian/", 0), ("/", 1)], ids=["archive", "both"])
def test_the_beginning_of_a_file_is_no_package(project: Project, breaks_off: str, code: int) -> None:
    project.archive.breaks_off = breaks_off
    assert project.fetch(LOCKED="1").returncode == code
    wanted = {line.split()[2] for line in project.lock.read_text().splitlines()[1:]}
    pool = project.folder / "build/packages/pool"
    assert {hashlib.sha256(deb.read_bytes()).hexdigest() for deb in pool.glob("*.deb")} == (set() if code else wanted)


@pytest.mark.parametrize("trouble", [{"has_snapshots": False}, {"wrong": True}], ids=["none", "wrong"])
def test_where_no_snapshot_has_it_a_locked_build_fails(project: Project, trouble: dict[str, bool]) -> None:
    vars(project.archive).update(trouble)
    done = project.fetch(LOCKED="1")
    assert done.returncode == 1
    gone = "alpha_1_all.deb beta_1_all.deb gamma_1_all.deb"
    assert f"neither the archive nor its snapshots have: {gone}." in done.stderr
    assert project.laid_out() == []


@pytest.mark.parametrize("trouble", [{"has_snapshots": False}, {"wrong": True}], ids=["none", "wrong"])
def test_where_no_snapshot_has_it_a_build_goes_on_with_todays_versions(
    project: Project, trouble: dict[str, bool]
) -> None:
    vars(project.archive).update(trouble)
    lock = project.lock.read_text()
    done = project.fetch()
    assert done.returncode == 0, done.stderr
    assert "Going on with today's versions (build/lock)" in done.stderr
    assert project.laid_out() == TODAY
    assert project.lock.read_text() == lock


def test_a_build_takes_the_lock_again_as_soon_as_it_can_be_had(project: Project) -> None:
    project.archive.has_snapshots = False
    assert project.fetch().returncode == 0
    assert project.fetch(LOCKED="1").returncode == 1
    project.archive.has_snapshots = True
    assert project.fetch().returncode == 0
    assert project.laid_out() == OLD


def test_todays_versions_are_chosen_once_a_day(project: Project) -> None:
    def build() -> bool:
        """Has it asked for lists?"""
        project.archive.asked.clear()
        done = project.fetch()
        assert done.returncode == 0, done.stderr
        assert project.laid_out() == TODAY
        return any("/dists/" in path for path in project.archive.asked)

    chosen, yesterday = project.folder / "build/lock/tools.lock", time.time() - 86400
    project.archive.has_snapshots = False
    assert build()
    assert not build()
    os.utime(project.folder / "images/tools.packages")
    assert build(), "for what the image is made of now"
    os.utime(project.folder / "images/tools.packages", (yesterday - 1, yesterday - 1))
    os.utime(chosen, (yesterday, yesterday))
    assert build()
    project.archive.close()
    assert not build()


def test_a_new_lock_ends_the_one_that_replaced_it(project: Project) -> None:
    project.archive.has_snapshots = False
    assert project.fetch().returncode == 0
    lines = [line for line in project.lock.read_text().splitlines() if "delta" in line or line.startswith("#")]
    project.lock.write_text("\n".join([*lines, ""]))
    assert project.fetch().returncode == 0
    assert project.laid_out() == ["delta_1_all.deb"]


def test_without_a_network_the_build_says_so(project: Project) -> None:
    project.archive.close()
    done = project.fetch()
    assert done.returncode == 1
    assert "the archive does not answer (is the network up?)" in done.stderr


def test_a_new_lock_says_what_has_changed_and_what_is_a_security_update(project: Project) -> None:
    changes = [
        "alpha 1 -> 2: tools",
        "beta 1 -> 2: tools",
        "gamma 1 -> 2 (security update): tools",
    ]
    lock = project.lock.read_text()
    check = project.run("ci/images-lock", "--check", "tools")
    assert (check.returncode, check.stdout.splitlines()) == (1, changes)
    assert project.lock.read_text() == lock
    done = project.run("ci/images-lock", "tools")
    assert (done.returncode, done.stdout.splitlines()) == (0, changes)
    assert project.lock.read_text().splitlines()[0] == f"# snapshot {SNAPSHOT}"
    check = project.run("ci/images-lock", "--check", "tools")
    assert (check.returncode, check.stdout) == (0, "")
    assert project.fetch(LOCKED="1").returncode == 0
    assert project.laid_out() == TODAY


def test_a_lock_stays_when_only_other_packages_have_changed(project: Project) -> None:
    assert project.run("ci/images-lock", "tools").returncode == 0
    lock = project.lock.read_text()
    project.archive.add("epsilon", "1")
    project.archive.publish(later=3600)
    done = project.run("ci/images-lock", "tools")
    assert (done.returncode, done.stdout) == (0, "")
    assert project.lock.read_text() == lock
    project.archive.add("delta", "2")
    project.archive.publish(later=7200)
    assert project.run("ci/images-lock", "tools").returncode == 0
    assert project.lock.read_text().splitlines()[0] == "# snapshot 20261126T042231Z"


def test_an_archive_that_cannot_be_asked_is_no_answer(project: Project) -> None:
    project.archive.close()
    assert project.run("ci/images-lock", "--check", "tools").returncode == 2
