"""The ROS master seen from a program: timed calls, waiting for it, and noticing that it has forgotten a node.

Without a master rospy just hangs (in `init_node`), and it does not register again with a restarted one. So a node that
serves for a whole evening first waits for the master, and begins anew when the master has forgotten it. A node does not
end because the master is slow: connections between nodes work without it.
"""

import http.client
import logging
import threading
import time
import uuid
import xmlrpc.client
from collections.abc import Callable
from typing import Any
from xml.parsers.expat import ExpatError

_log = logging.getLogger(__name__)


# what xmlrpc.client makes of other answers than those of a ROS master
_NO_ANSWER = (http.client.HTTPException, xmlrpc.client.Error, ExpatError, ArithmeticError, TypeError, ValueError)


class MasterError(Exception):
    """The master answered, but not with success."""


class _TimedTransport(xmlrpc.client.Transport):
    def __init__(self, timeout: float) -> None:
        super().__init__()
        self._timeout = timeout

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = self._timeout
        return connection


class Master:
    """Calls of the Master API (wiki.ros.org/ROS/Master_API) in the name of a node, each answered within `timeout` s."""

    def __init__(self, uri: str, node: str, timeout: float = 1.0) -> None:
        self.uri = uri
        self.node = "/" + node.lstrip("/")
        self.timeout = timeout

    def call(self, method: str, *arguments: Any) -> Any:
        """The value that it returns. MasterError when it reports a failure, OSError when there is no such answer."""
        try:
            with xmlrpc.client.ServerProxy(self.uri, transport=_TimedTransport(self.timeout)) as proxy:
                code, text, value = getattr(proxy, method)(self.node, *arguments)
        except _NO_ANSWER as error:
            raise OSError(f"{self.uri} does not answer as a ROS master: {error}") from None
        if code != 1:
            raise MasterError(text)
        return value

    def wait(self, stop: threading.Event) -> bool:
        """Return True as soon as it answers, or False once `stop` is set. Logs while it waits."""
        told = False
        while not stop.is_set():
            try:
                self.call("getPid")
            except (OSError, MasterError) as error:
                if not told:
                    _log.warning(
                        "no ROS master at %s (%s): waiting; start roscore, or set ROS_MASTER_URI", self.uri, error
                    )
                told = True
                stop.wait(0.3)
            else:
                if told:
                    _log.info("the ROS master at %s answers", self.uri)
                return True
        return False


class MasterWatch:
    """Calls `on_lost(reason)` once, from its own thread, when the master has lost the node, or is gone; `on_replaced`,
    if given, when another node has taken its name.

    The watch leaves a mark with the master, the private parameter `/<node>/alive_mark`. A restarted master does not
    know it (process IDs say nothing: in a container it is always 1), and another node of the same name replaces it.
    A master that hangs is waited for. It is gone when for `gone_after` seconds nothing listens on its port.
    """

    def __init__(
        self,
        master: Master,
        on_lost: Callable[[str], None],
        on_replaced: Callable[[str], None] | None = None,
        period: float = 1.0,
        gone_after: float = 10.0,
    ) -> None:
        self._master = master
        self._key = f"{master.node}/alive_mark"
        self._mark = uuid.uuid4().hex
        self._on_lost = on_lost
        self._on_replaced = on_replaced or on_lost
        self._period = period
        self._gone_after = gone_after
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="master-watch", daemon=True)

    def start(self) -> None:
        """Leave the mark and watch. Call it before `rospy.init_node`, so that no restart goes unseen.

        OSError when the master cannot be reached.
        """
        try:
            self._master.call("setParam", self._key, self._mark)
        except MasterError as error:
            raise OSError(f"the ROS master at {self._master.uri} failed: {error}") from error
        self._thread.start()

    def stop(self) -> None:
        """End the watch; nothing is called any more."""
        self._stop.set()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(self._master.timeout + 0.5)

    def _run(self) -> None:
        silent = False
        listened = time.monotonic()
        while not self._stop.wait(self._period):
            try:
                found = self._master.call("getParam", self._key)
            except MasterError:
                return self._end(self._on_lost, "the ROS master was restarted and no longer knows this node")
            except OSError as error:
                if not isinstance(error, ConnectionRefusedError):
                    listened = time.monotonic()
                if time.monotonic() - listened >= self._gone_after:
                    return self._end(self._on_lost, f"the ROS master at {self._master.uri} is gone ({error})")
                if not silent:
                    _log.warning("the ROS master at %s does not answer (%s); going on", self._master.uri, error)
                silent = True
            else:
                if found != self._mark:
                    return self._end(self._on_replaced, f"another node has taken the name {self._master.node}")
                if silent:
                    _log.info("the ROS master answers again")
                silent, listened = False, time.monotonic()

    def _end(self, tell: Callable[[str], None], reason: str) -> None:
        if not self._stop.is_set():
            tell(reason)
