"""Notices that the ROS master has forgotten this node: after a restart it knows none of our topics."""

import http.client
import logging
import threading
import xmlrpc.client
from collections.abc import Callable
from typing import Any

PERIOD = 2.0  # s
TIMEOUT = 2.0  # s

log = logging.getLogger("robot.master_watch")


class _Transport(xmlrpc.client.Transport):
    def make_connection(self, host: object) -> http.client.HTTPConnection:
        connection = super().make_connection(host)  # type: ignore[arg-type]
        connection.timeout = TIMEOUT
        return connection


class Master:
    """The few questions to the ROS master; each raises OSError when there is no sensible answer."""

    def __init__(self, uri: str, caller_id: str) -> None:
        self._uri = uri
        self._caller_id = caller_id

    def pid(self) -> int:
        return int(self._ask("getPid")[2])

    def node_uri(self, name: str) -> str | None:
        """Where the node is registered, None if it is unknown."""
        code, _, uri = self._ask("lookupNode", name)
        return str(uri) if code == 1 else None

    def _ask(self, question: str, *arguments: str) -> tuple[int, str, Any]:
        try:
            with xmlrpc.client.ServerProxy(self._uri, transport=_Transport()) as proxy:
                code, text, value = getattr(proxy, question)(self._caller_id, *arguments)
        except (xmlrpc.client.Error, http.client.HTTPException) as error:
            raise OSError(f"{self._uri} does not answer as a ROS master: {error}") from None
        return code, text, value


class MasterWatch(threading.Thread):
    """Asks the master every 2 s who we are; calls `on_forgotten(reason)` once when it does not know us any more.

    A master that does not answer is no reason to end: the connections between nodes live without it.
    """

    def __init__(self, master: Master, name: str, uri: str, on_forgotten: Callable[[str], None]) -> None:
        super().__init__(name="master watch", daemon=True)
        self._master = master
        self._node = name
        self._uri = uri
        self._on_forgotten = on_forgotten
        self._pid = master.pid()
        self._end = threading.Event()

    def run(self) -> None:
        answering = True
        while not self._end.wait(PERIOD):
            try:
                pid, uri = self._master.pid(), self._master.node_uri(self._node)
            except OSError as error:
                if answering:
                    log.warning("the ROS master does not answer: %s", error)
                answering = False
                continue
            if pid != self._pid or uri != self._uri:
                self._on_forgotten(f"the ROS master was restarted or has lost {self._node}")
                return
            if not answering:
                log.info("the ROS master answers again")
            answering = True

    def stop(self) -> None:
        self._end.set()
