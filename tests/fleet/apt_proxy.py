"""The LAN's way to Debian packages: an HTTP proxy for apt that keeps every package it has fetched.

    python3 apt_proxy.py ADDRESS PORT FOLDER

The rehearsed hosts take their packages through it, as hosts in a LAN without internet do.
"""

import http.server
import os
import shutil
import socketserver
import sys
import tempfile
import urllib.error
import urllib.request
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Proxy(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    folder: Path

    def do_GET(self) -> None:
        """Packages never change under their name; the lists do, and are fetched each time."""
        kept = self.folder / Path(unquote(urlsplit(self.path).path)).name
        if kept.suffix == ".deb" and kept.exists():
            with kept.open("rb") as file:
                self._answer(file, kept.stat().st_size)
            return
        wanted = {name: value for name, value in self.headers.items() if name in ("If-Modified-Since", "Range")}
        try:
            with (
                urllib.request.urlopen(urllib.request.Request(self.path, headers=wanted), timeout=60) as reply,
                tempfile.NamedTemporaryFile(dir=self.folder) as copy,
            ):
                shutil.copyfileobj(reply, copy)
                if kept.suffix == ".deb" and reply.status == 200:
                    os.link(copy.name, f"{copy.name}.whole")
                    os.replace(f"{copy.name}.whole", kept)
                size = copy.tell()
                copy.seek(0)
                self._answer(copy, size, reply.status, dict(reply.headers))
        except urllib.error.HTTPError as error:
            self._fail(error.code)
        except OSError:
            self._fail(502)

    def _fail(self, status: int) -> None:
        self.send_response(status)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def _answer(self, file, size: int, status: int = 200, headers: dict[str, str] | None = None) -> None:
        self.send_response(status)
        self.send_header("Content-Length", str(size))
        for name in ("Last-Modified", "Content-Range"):
            if headers and name in headers:
                self.send_header(name, headers[name])
        self.end_headers()
        shutil.copyfileobj(file, self.wfile)

    def log_message(self, *_: object) -> None:
        """Nobody reads it."""


class Server(socketserver.ThreadingMixIn, http.server.HTTPServer):
    daemon_threads = True


if __name__ == "__main__":
    Proxy.folder = Path(sys.argv[3])
    Server((sys.argv[1], int(sys.argv[2])), Proxy).serve_forever()
