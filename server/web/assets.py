"""How browsers get pages, compressed, and what pages load: server/static/bundle, made by server/static/build.mjs, under
names that carry a hash of the content, so that a browser asks for each file once."""

import gzip
import json
from functools import cache
from pathlib import Path
from wsgiref.types import WSGIApplication

from flask import Response, request
from whitenoise import WhiteNoise

_BUNDLE = Path(__file__).resolve().parents[1] / "static" / "bundle"
STATIC = "/static/"
_HASHED = r"-[0-9A-Z]{8}\."
_LEVEL = 6  # of gzip: a page takes half a millisecond, and level 9 makes it no smaller


@cache
def _manifest() -> dict[str, str]:
    try:
        names: dict[str, str] = json.loads((_BUNDLE / "manifest.json").read_text())
    except OSError as error:
        raise FileNotFoundError(f"{_BUNDLE} has not been made: run make, or npm run build") from error
    return names


def asset(name: str) -> str:
    """The address of a file of server/static, such as "css/common.css" or "js/game/home.js". KeyError: it has none."""
    return STATIC + _manifest()[name]


def with_assets(application: WSGIApplication) -> WSGIApplication:
    """The application, with the files below /static/: kept for good, compressed for browsers that can read that."""

    def add_headers(headers: dict[str, str], _path: str, _url: str) -> None:
        headers["X-Content-Type-Options"] = "nosniff"

    files: WSGIApplication = WhiteNoise(
        application,
        root=_BUNDLE,
        prefix=STATIC,
        immutable_file_test=_HASHED,
        allow_all_origins=False,
        add_headers_function=add_headers,
    )
    return files


def compress_page(response: Response) -> Response:
    """The response; a page at a third of its size for browsers that read gzip."""
    if response.mimetype == "text/html":
        response.vary.add("Accept-Encoding")
        if request.accept_encodings["gzip"] and not response.direct_passthrough:
            response.set_data(gzip.compress(response.get_data(), _LEVEL))
            response.content_encoding = "gzip"
    return response
