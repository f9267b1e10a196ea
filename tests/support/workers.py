"""Which tests run beside each other when there are several workers (pytest -n 4)."""

import re
from functools import cache

from xdist.scheduler import LoadFileScheduling

from tests.support.programs import ROOT

STARTS_MUCH = re.compile(r"^from tests\.support\.(battle|demo) |^from playwright", re.MULTILINE)


class Scheduling(LoadFileScheduling):
    """A file stays with one worker, and all files whose tests start a demo or a browser stay with the same: each of
    those is more work than one processor does."""

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.split("::", 1)[0]
        return "demo" if starts_much(file) else file


@cache
def starts_much(file: str) -> bool:
    return STARTS_MUCH.search((ROOT / file).read_text()) is not None
