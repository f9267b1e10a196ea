"""A web server that knows only POST /incAlive: real HTTP, with an answer that the test chooses."""

import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Self

from tests.support.ports import free_port


class WebServer:
    """Records (time, path, body) of each ping and answers with `answer`; `port` stays over stop() and start()."""

    def __init__(self) -> None:
        self.port = free_port()
        self.pings: list[tuple[float, str, str]] = []
        self.code = 200
        self.answer = '{"status": "OK"}'
        self.delay = threading.Event()  # while set, answers do not come
        self._server: ThreadingHTTPServer | None = None

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/incAlive"

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        owner = self

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self) -> None:
                body = self.rfile.read(int(self.headers["Content-Length"])).decode()
                owner.pings.append((time.monotonic(), self.path, body))
                while owner.delay.is_set():
                    time.sleep(0.01)
                self.send_response(owner.code)
                self.send_header("Content-Type", "text/html; charset=utf-8")
                self.send_header("Content-Length", str(len(owner.answer)))
                self.end_headers()
                self.wfile.write(owner.answer.encode())

            def log_message(self, *_: object) -> None:
                pass

        self._server = ThreadingHTTPServer(("127.0.0.1", self.port), Handler)
        threading.Thread(target=self._server.serve_forever, args=[0.02], name="web").start()

    def stop(self) -> None:
        self.delay.clear()
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
            self._server = None
