"""nginx's configuration, from the settings."""

from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from laser_bot_battle import listening
from server.front.settings import FrontSettings

HERE = Path(__file__).parent
RATE = 50  # requests/s of one address; a page that plays asks for 2
# and at once; files come from the front's own memory, all else could be many addresses' and fill the server's places
AT_ONCE, FILES_AT_ONCE = 50, 200  # a page that loads asks for some 40 files
# of one address at once; a hall's visitors may share one
CONNECTIONS = 300
WAITING = 400  # requests that are held back till their turn: all of those connections, for a refusal begets the next
HTTP_PORT, HTTPS_PORT = 80, 443  # that addresses need not name
USER = "nobody"  # of nginx's workers, where the program is root's


def configuration(settings: FrontSettings, folder: Path, is_root: bool) -> str:
    """The text. nginx keeps its own files in `folder`."""
    templates = Environment(
        loader=FileSystemLoader(HERE), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return templates.get_template("nginx.conf.j2").render(
        folder=folder,
        user=f"{USER} nogroup" if is_root else "",
        log_level="info" if settings.log_level == "debug" else "error",
        connections=CONNECTIONS,
        rate=RATE,
        at_once=AT_ONCE,
        files_at_once=FILES_AT_ONCE,
        waiting=WAITING,
        host=_here(settings),
        ports={
            "web": settings.web_port,
            "rosbridge": settings.rosbridge_port,
            "relay": settings.relay_port,
        },
        servers=_servers(settings),
        certificate=settings.certificate,
        tls_ports=_tls_ports(settings),
    )


def _here(settings: FrontSettings) -> str:
    """Where the game's programs are to be had."""
    first = listening.addresses(settings.bind)[0]
    return "127.0.0.1" if first in ("0.0.0.0", "::") else _bracketed(first)


def _tls_ports(settings: FrontSettings) -> dict[str, str]:
    """The port of an https:// address for visitors whose own address has a port, and for those whose has none.

    A visitor without one at a port other than 80 was led here from 80, as by a load balancer: so is 443.
    """
    port = "" if settings.https_port == HTTPS_PORT else f":{settings.https_port}"
    return {"named": port, "usual": port if settings.http_port == HTTP_PORT else ""}


def _servers(settings: FrontSettings) -> list[dict[str, Any]]:
    wanted = [(settings.http_port, False)]
    if settings.certificate:
        wanted.append((settings.https_port, True))
    return [{"addresses": _addresses(settings.bind, port), "tls": tls} for port, tls in wanted]


def _addresses(bind: str, port: int) -> list[str]:
    """As nginx writes them. Those of IPv6 have a socket of their own: visitors by IPv4 keep their addresses."""
    return [
        f"{_bracketed(address)}:{port}{' ipv6only=on' if ':' in address else ''}"
        for address in listening.addresses(bind)
    ]


def _bracketed(address: str) -> str:
    return f"[{address}]" if ":" in address else address
