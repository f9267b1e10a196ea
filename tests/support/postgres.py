"""A PostgreSQL server of the tests' own, by Debian's package, on a free port of the loopback interface."""

import os
import secrets
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pg8000.dbapi
import psutil
import pytest
from sqlalchemy import URL

from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program

HOST = "127.0.0.1"
USER = "laserbot"


class Postgres:
    """It refuses to run as root: then it runs as the user that its package makes."""

    def __init__(self) -> None:
        self.port = free_port()
        self.password = secrets.token_hex(8)
        self._databases = 0
        self._home = Path(tempfile.mkdtemp(prefix="postgres-"))
        self._folder = self._home / "data"
        self._as: list[str] = []
        if os.geteuid() == 0:
            shutil.chown(self._home, "postgres", "postgres")
            self._as = ["--reuid=postgres", "--regid=postgres", "--clear-groups"]
        secret = self._home / "password"
        secret.write_text(self.password)
        secret.chmod(0o644)  # in a folder that only its owner may enter
        options = ["--auth=scram-sha-256", f"--username={USER}", f"--pwfile={secret}", "--encoding=UTF8", "--no-locale"]
        command = self._command("initdb", f"--pgdata={self._folder}", "--no-sync", *options)
        subprocess.run(command, check=True, capture_output=True)
        self._program: Program | None = None

    def start(self, *more: str) -> None:
        """Go on with what is there, by these settings, too."""
        settings = [f"listen_addresses={HOST}", f"port={self.port}", "unix_socket_directories=", "fsync=off", *more]
        words = [word for setting in settings for word in ("-c", setting)]
        self._program = Program(self._command("postgres", "-D", str(self._folder), *words))
        self._program.wait_for("ready to accept connections", 60)

    def kill(self) -> None:
        """As a power cut; until it is gone."""
        assert self._program
        everyone = self._processes()
        self._program.kill()
        # what it has started is in sessions of its own
        for process in everyone:
            with_its_end(process)

    def pause(self) -> None:
        """It hangs until resume()."""
        for process in self._processes():
            process.suspend()

    def resume(self) -> None:
        for process in self._processes():
            process.resume()

    def remove(self) -> None:
        if self._program and self._program.running:
            self._program.stop(signal.SIGINT, 30)
        shutil.rmtree(self._home)

    def new_database(self) -> URL:
        """The address of an empty one."""
        self._databases += 1
        name = f"game{self._databases}"
        with closing(pg8000.dbapi.connect(USER, HOST, "postgres", self.port, self.password)) as connection:
            connection.autocommit = True
            connection.cursor().execute(f"CREATE DATABASE {name}")
        return URL.create("postgresql+pg8000", USER, self.password, HOST, self.port, name)

    def _processes(self) -> list[psutil.Process]:
        assert self._program
        first = psutil.Process(self._program.process.pid)
        return [first, *first.children(recursive=True)]

    def _command(self, program: str, *arguments: str) -> list[str]:
        newest = max(Path("/usr/lib/postgresql").glob(f"*/bin/{program}"), key=lambda path: int(path.parts[4]))
        # from a folder that its user may enter
        return ["env", f"--chdir={self._home}", "setpriv", "--pdeathsig=INT", *self._as, str(newest), *arguments]


def with_its_end(process: psutil.Process) -> None:
    """Wait until it is gone."""
    until(lambda: not process.is_running() or process.status() == psutil.STATUS_ZOMBIE, 20, f"the end of {process}")


@contextmanager
def running_postgres(*settings: str) -> Iterator[Postgres]:
    server = Postgres()
    try:
        server.start(*settings)
        yield server
    finally:
        server.remove()


@pytest.fixture(scope="module")
def postgres(temporary_files: Path) -> Iterator[Postgres]:
    """One for a module."""
    with running_postgres() as server:
        yield server


@pytest.fixture
def own_postgres() -> Iterator[Postgres]:
    """One to do harm to."""
    with running_postgres() as server:
        yield server
