"""What a program tells those who watch it (docs/monitoring.md): `/metrics` for Prometheus, `/healthz`, `/readyz`.

Nothing is counted here. Who owns the figures keeps plain numbers, and is asked for them at each visit: so counting
costs a command next to nothing, and a visit shows that the owner answers.
"""

import asyncio
import logging
import socketserver
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import TimeoutError as LateError
from contextlib import contextmanager
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from typing import Any, TypeVar

from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, ProcessCollector, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from laser_bot_battle import listening
from laser_bot_battle.connection_limits import ConnectionLimits
from laser_bot_battle.names import WATCHED

T = TypeVar("T")
Address = tuple[str, int]  # where the first of the programs is watched

PATIENCE = 5.0  # s, with a visitor, and with the owner of the figures
TEXT = "text/plain; charset=utf-8"
# each visitor has a thread of the program's own
VISITORS, OF_ONE_MACHINE = 40, 10  # at once: in all, and from one other machine
VISIT = 30.0  # s that one may stay when there are too many

_log = logging.getLogger(__name__)


def gauge(name: str, text: str, value: float) -> Metric:
    """What goes up and down."""
    return GaugeMetricFamily(name, text, value=value)


def counter(name: str, text: str, value: float) -> Metric:
    """What only grows, until the program starts again; the name ends with `_total`."""
    return CounterMetricFamily(name, text, value=value)


def labelled(
    kind: type[GaugeMetricFamily] | type[CounterMetricFamily],
    name: str,
    text: str,
    labels: Sequence[str],
    values: Mapping[tuple[str, ...], float],
) -> Metric:
    """One value for each combination of the labels."""
    family = kind(name, text, labels=labels)
    for of, value in values.items():
        family.add_metric(of, value)
    return family


@dataclass(frozen=True)
class Owner:
    """Whom a visitor's thread asks. Both raise what they like if they cannot answer, which counts as not healthy."""

    metrics: Callable[[], Iterable[Metric]]
    missing: Callable[[], str]  # what the program lacks to do its work now, "" if nothing


def in_loop(owner: Owner) -> Owner:
    """The same, asked in the running event loop: there it changes nothing while it is read."""
    loop = asyncio.get_running_loop()

    def asked(ask: Callable[[], T]) -> Callable[[], T]:
        async def answer() -> T:
            return ask()

        return lambda: asyncio.run_coroutine_threadsafe(answer(), loop).result(PATIENCE)

    return Owner(asked(lambda: list(owner.metrics())), asked(owner.missing))


@contextmanager
def watched(program: str, first: Address | None, owner: Owner) -> Iterator[None]:
    """Answer visitors in threads, at the program's place among `WATCHED` from the port of `first` on. Nobody plays
    worse because it cannot be watched: a port that cannot be had is only logged."""
    if first is None:
        yield
        return
    bind, port = first[0], first[1] + WATCHED.index(program)
    try:
        server = _Server(bind, port, owner)
    except OSError as error:
        _log.error("cannot be watched on %s port %d: %s; see LASERBOT_METRICS", bind, port, error.strerror or error)
        yield
        return
    with server:
        threading.Thread(target=server.serve_forever, name="watched", daemon=True).start()
        _log.info("watched at http://%s:%d/metrics", bind, port)
        try:
            yield
        finally:
            server.shutdown()


class _Metrics(Collector):
    def __init__(self, owner: Owner) -> None:
        self._owner = owner

    def collect(self) -> Iterable[Metric]:
        return self._owner.metrics()

    def describe(self) -> Iterable[Metric]:
        return ()  # or they would be collected now


class _Server(socketserver.ThreadingTCPServer):
    daemon_threads = True

    def __init__(self, bind: str, port: int, owner: Owner) -> None:
        self.owner = owner
        self._limits = ConnectionLimits(VISITORS, VISIT, OF_ONE_MACHINE)
        self.registry = CollectorRegistry()
        self.registry.register(_Metrics(owner))
        ProcessCollector(registry=self.registry)
        super().__init__((bind, port), _Visitor, bind_and_activate=False)
        self.socket.close()
        self.socket = listening.bind(bind, port)  # type: ignore[assignment]  # it does all that the server asks of one
        self.server_activate()

    def verify_request(self, request: Any, client_address: Any) -> bool:
        return self._limits.take(request, client_address[0])

    def handle_error(self, request: Any, client_address: Any) -> None:
        _log.debug("a visitor at %s was lost", client_address, exc_info=True)


class _Visitor(BaseHTTPRequestHandler):
    server: _Server
    timeout = PATIENCE

    def do_GET(self) -> None:
        pages = {"/metrics": self._metrics, "/healthz": self._healthz, "/readyz": self._readyz}
        page = pages.get(self.path.partition("?")[0])
        try:
            status, kind, body = page() if page else (HTTPStatus.NOT_FOUND, TEXT, f"{' '.join(pages)}\n".encode())
        except Exception as error:  # whatever it was, it is the answer
            what = f"no answer within {PATIENCE:g} s" if isinstance(error, LateError) else f"failed: {error}"
            status, kind, body = HTTPStatus.SERVICE_UNAVAILABLE, TEXT, f"{what}\n".encode()
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def _metrics(self) -> tuple[HTTPStatus, str, bytes]:
        return HTTPStatus.OK, CONTENT_TYPE_LATEST, generate_latest(self.server.registry)

    def _healthz(self) -> tuple[HTTPStatus, str, bytes]:
        self.server.owner.missing()
        return HTTPStatus.OK, TEXT, b"ok\n"

    def _readyz(self) -> tuple[HTTPStatus, str, bytes]:
        missing = self.server.owner.missing()
        status = HTTPStatus.SERVICE_UNAVAILABLE if missing else HTTPStatus.OK
        return status, TEXT, f"{missing or 'ok'}\n".encode()

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - http.server's name
        _log.debug(format, *args)
