"""The sub-protocol of a WebSocket (RFC 6455, 4.2.2). Ours have none, but a client that offers some may need one."""

import re
from collections.abc import Iterable

HEADER = "Sec-WebSocket-Protocol"
_TOKEN = re.compile(r"[!#$%&'*+.^_`|~0-9A-Za-z-]+")  # RFC 9110, 5.6.2


def chosen(offers: Iterable[str]) -> str | None:
    """The first of what the headers `HEADER` offer; what cannot be a sub-protocol's name is passed over.

    Chromium and other clients give a connection up when they have offered some and the server has chosen none.
    """
    words = (word.strip(" \t") for offer in offers for word in offer.split(","))
    return next((word for word in words if _TOKEN.fullmatch(word)), None)
