"""Answers that are the same for all are made once for each change, and sent again to whoever asks the same."""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable
from typing import NamedTuple
from wsgiref.types import StartResponse, WSGIApplication, WSGIEnvironment

from werkzeug.wrappers import Request, Response

from laser_bot_battle.names import FRONT_HEADER
from laser_bot_battle.proxies import SCHEME
from server.pages.audience import PREFIX as AUDIENCE
from server.web.assets import STATIC
from server.web.words import LANGUAGE_COOKIE, THEME_COOKIE

MAX_SIZE = 16 << 20  # bytes, of all that is kept
LATEST = 10.0  # s; a page may tell the day, or this machine's addresses
UNMARKED = 1.0  # s, where nobody knows whether anything has changed
# A battle changes the database several times a second. An answer is kept for this many times as long as it took to
# make, whatever changes meanwhile.
REST = 4
_OVERHEAD = 2048  # bytes of an answer besides its body


class _Kept(NamedTuple):
    status: int
    headers: list[tuple[str, str]]
    body: bytes
    mark: object
    began_at: float  # when it was made, s
    took: float  # s

    @property
    def size(self) -> int:
        return len(self.body) + _OVERHEAD


class KeptAnswers:
    """The WSGI application, asked only for what is not known. `mark` is another one after each change, or None."""

    def __init__(
        self, application: WSGIApplication, mark: Callable[[], object], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._application = application
        self._mark = mark
        self._clock = clock
        self._makers = [threading.Lock() for _ in range(64)]  # who makes an answer; others who want it wait for it
        self._lock = threading.Lock()
        self._kept: OrderedDict[Hashable, _Kept] = OrderedDict()  # what was asked last is last
        self._size = 0

    def __call__(self, environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        request = Request(environ)
        if request.method not in ("GET", "HEAD") or request.path.startswith((STATIC, AUDIENCE)):
            return self._application(environ, start_response)
        question = _question(request)
        with self._makers[hash(question) % len(self._makers)]:
            kept = self._find(question) or self._make(question, request)
        response = Response(kept.body, kept.status, kept.headers)
        if kept.status == 200 and not response.cache_control.no_store:
            response.add_etag()
            response.make_conditional(request)
        return response(environ, start_response)

    def _find(self, question: Hashable) -> _Kept | None:
        """What is known and still true, or was true so recently that making it anew would not pay."""
        mark = self._mark()
        with self._lock:
            kept = self._kept.get(question)
            if kept is None:
                return None
            age = self._clock() - kept.began_at
            if age > (UNMARKED if mark is None else LATEST):
                return None
            if kept.mark != mark and age >= (1 + REST) * kept.took:
                return None
            self._kept.move_to_end(question)
            return kept

    def _make(self, question: Hashable, request: Request) -> _Kept:
        mark, now = self._mark(), self._clock()
        made = Response.from_app(self._application, {**request.environ, "REQUEST_METHOD": "GET"}, buffered=True)
        kept = _Kept(made.status_code, list(made.headers), made.data, mark, now, self._clock() - now)
        if kept.status == 200:
            with self._lock:
                former = self._kept.pop(question, None)
                self._kept[question] = kept
                self._size += kept.size - (former.size if former else 0)
                while self._size > MAX_SIZE:
                    self._size -= self._kept.popitem(last=False)[1].size
        return kept


def _question(request: Request) -> Hashable:
    """All that an answer depends on."""
    headers = request.headers
    return (
        request.path,
        request.query_string,
        bool(request.accept_encodings["gzip"]),
        request.cookies.get(LANGUAGE_COOKIE),
        request.cookies.get(THEME_COOKIE),
        *(headers.get(name) for name in ("Host", "Accept-Language", FRONT_HEADER, SCHEME)),
    )
