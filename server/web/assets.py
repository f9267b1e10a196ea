"""What browsers get besides pages: server/static/bundle, made by server/static/build.mjs, under names that carry a
hash of the content, so that a browser asks for each file once."""

import json
from functools import cache
from pathlib import Path
from wsgiref.types import WSGIApplication

from whitenoise import WhiteNoise

_BUNDLE = Path(__file__).resolve().parents[1] / "static" / "bundle"
_PREFIX = "/static/"
_HASHED = r"-[0-9A-Z]{8}\."


@cache
def _manifest() -> dict[str, str]:
    try:
        names: dict[str, str] = json.loads((_BUNDLE / "manifest.json").read_text())
    except OSError as error:
        raise FileNotFoundError(f"{_BUNDLE} has not been made: run make, or npm run build") from error
    return names


def asset(name: str) -> str:
    """The address of a file of server/static, such as "css/common.css" or "js/home.js". KeyError: it has none."""
    return _PREFIX + _manifest()[name]


def with_assets(application: WSGIApplication) -> WSGIApplication:
    """The application, with the files below /static/: kept for good, compressed for browsers that can read that."""

    def add_headers(headers: dict[str, str], _path: str, _url: str) -> None:
        headers["X-Content-Type-Options"] = "nosniff"

    files: WSGIApplication = WhiteNoise(
        application,
        root=_BUNDLE,
        prefix=_PREFIX,
        immutable_file_test=_HASHED,
        allow_all_origins=False,
        add_headers_function=add_headers,
    )
    return files
