"""The connection to a database server is encrypted if the server can do that, and plain otherwise.

So does pg8000 by itself. But for each connection it reads all the authorities that this machine trusts, and asks none
of them: that takes 30 ms of a processor, most of what a look at the results takes.
"""

import ssl
from functools import cache
from typing import Any

from sqlalchemy import Engine, event

_REFUSAL = "Server refuses SSL"  # pg8000's words


def encrypt_if_possible(engine: Engine) -> None:
    """All connections that the engine, of a server, will open."""

    @event.listens_for(engine, "do_connect")
    def connect(dialect: Any, _record: object, words: list[Any], options: dict[str, Any]) -> Any:
        try:
            return dialect.connect(*words, **options, ssl_context=_context())
        except dialect.loaded_dbapi.InterfaceError as error:
            if _REFUSAL not in str(error):
                raise
            return dialect.connect(*words, **options, ssl_context=False)


@cache
def _context() -> ssl.SSLContext:
    """The server's certificate is nobody's in particular, as in pg8000."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return context
