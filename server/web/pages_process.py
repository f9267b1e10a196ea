"""The process that makes what people look at (server.pages): started with the game server, and again when it ends.

It answers on a socket of its own; what comes for it on the game server's port is handed over. It stands behind the
game for the processor too, so a crowd of visitors costs a battle next to nothing.
"""

import contextlib
import logging
import socket
import string
import subprocess
import sys
import threading
from collections.abc import Iterable
from http.client import HTTPConnection, HTTPException, HTTPResponse
from urllib.parse import quote
from wsgiref.types import StartResponse, WSGIEnvironment

from laser_bot_battle.backoff import STEADY, Backoff

_log = logging.getLogger(__name__)

_ANSWER_WITHIN = 10.0  # s; a database that is away is known sooner
_END_WITHIN = 1.0  # s
_LONGEST_PAUSE = 5.0  # s until it is started again
_WAITING = 128  # connections
# each server's own; what a client expects before its body, it has had from ours
_HOP_BY_HOP = {"connection", "keep-alive", "transfer-encoding", "date", "server", "via", "expect"}
_AWAY = b"The pages are being started: try again in a moment.\n"


class PagesProcess:
    """Starts the process in `run`; as a WSGI application, hands requests without a body over to it."""

    def __init__(self) -> None:
        # an address that the kernel makes up, in no file system: nothing to clean up, and it outlives the process
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind("")
        self._listener.listen(_WAITING)
        self._address: bytes = self._listener.getsockname()
        self._own = threading.local()  # each thread's connection
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._told = b""
        self._ending = threading.Event()

    def run(self) -> None:
        """Keep it running until `stop`. For a thread of its own."""
        backoff = Backoff(_LONGEST_PAUSE)
        while not self._ending.is_set():
            with self._lock:
                if self._ending.is_set():
                    return
                self._process = self._start()
            try:
                code = self._process.wait(STEADY)
            except subprocess.TimeoutExpired:
                backoff.worked()
                code = self._process.wait()
            pause = backoff.failed()
            if not self._ending.is_set():
                _log.error("the process of the pages has ended with %d: it is started again in %.1f s", code, pause)
            self._ending.wait(pause)

    def stop(self) -> None:
        self._ending.set()
        with self._lock:
            process = self._process
        if process is not None:
            process.stdin.close()  # type: ignore[union-attr]  # it ends with us
            try:
                process.wait(_END_WITHIN)
            except subprocess.TimeoutExpired:
                process.kill()
        self._listener.close()

    def tell(self, line: bytes) -> None:
        """Write a line to its standard input, now and whenever it is started again, until there is another one."""
        with self._lock:
            self._told = line
            if self._process is not None:
                self._write(self._process)

    def __call__(self, environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        asked = self._process
        try:
            response, body = self._ask(environ)
        except (OSError, HTTPException) as error:
            if isinstance(error, TimeoutError):
                self._end_hanging(asked)
            start_response(
                "503 SERVICE UNAVAILABLE",
                [("Content-Type", "text/plain"), ("Content-Length", str(len(_AWAY))), ("Retry-After", "2")],
            )
            return [_AWAY]
        headers = [(name, value) for name, value in response.getheaders() if name.lower() not in _HOP_BY_HOP]
        start_response(f"{response.status} {response.reason}", headers)
        return [body]

    def _start(self) -> "subprocess.Popen[bytes]":
        number = self._listener.fileno()
        process = subprocess.Popen(
            [sys.executable, "-m", "server.pages", str(number)],
            bufsize=0,  # what a process that has ended did not take would be written again when its input is closed
            stdin=subprocess.PIPE,
            pass_fds=[number],
        )
        self._write(process)
        return process

    def _write(self, process: "subprocess.Popen[bytes]") -> None:
        with contextlib.suppress(OSError):  # it has ended: the next one is told
            process.stdin.write(self._told)  # type: ignore[union-attr]

    def _ask(self, environ: WSGIEnvironment) -> tuple[HTTPResponse, bytes]:
        kept: _Connection | None = getattr(self._own, "connection", None)
        if kept is not None:
            try:
                return kept.ask(environ)
            except TimeoutError:
                raise
            except (OSError, HTTPException):  # it was closed: the process is another one, or has waited for long
                kept.close()
        fresh = self._own.connection = _Connection(self._address)
        try:
            return fresh.ask(environ)
        except (OSError, HTTPException):
            fresh.close()
            raise

    def _end_hanging(self, asked: "subprocess.Popen[bytes] | None") -> None:
        with self._lock:
            if asked is None or asked is not self._process or asked.poll() is not None:
                return  # another one has been started since
            _log.error("the process of the pages has not answered for %.0f s: it is ended", _ANSWER_WITHIN)
            asked.kill()


class _Connection(HTTPConnection):
    def __init__(self, address: bytes) -> None:
        super().__init__("localhost", timeout=_ANSWER_WITHIN)
        self._address = address

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX)
        self.sock.settimeout(self.timeout)
        self.sock.connect(self._address)

    def ask(self, environ: WSGIEnvironment) -> tuple[HTTPResponse, bytes]:
        """The answer, and its body."""
        path = quote(environ["PATH_INFO"].encode("latin-1"), safe="/:@!$&'()*+,;=~")
        query = quote(environ.get("QUERY_STRING", "").encode("latin-1"), safe=string.punctuation)
        self.putrequest(
            environ["REQUEST_METHOD"], f"{path}?{query}" if query else path, skip_host=True, skip_accept_encoding=True
        )
        for name, value in environ.items():
            if name.startswith("HTTP_") and (header := name[5:].replace("_", "-")).lower() not in _HOP_BY_HOP:
                self.putheader(header, value.encode("latin-1"))
        self.endheaders()
        response = self.getresponse()
        return response, response.read()
