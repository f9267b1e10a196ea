"""The ROS master seen from a node: waiting for it, and noticing that it has gone or forgotten us.

rospy neither says that there is no master (`init_node` hangs) nor registers again with a restarted one. A node that
serves for a whole evening therefore waits for the master first, and ends when it is lost: its supervisor starts it
anew.
"""

import http.client
import logging
import threading
import time
import uuid
import xmlrpc.client
from collections.abc import Callable
from typing import Any

_log = logging.getLogger(__name__)

_CALL_TIMEOUT = 1.0  # s; without one a call to a host that is switched off would hang for minutes
_UNREACHABLE = (OSError, http.client.HTTPException, xmlrpc.client.Error)


class MasterError(Exception):
    """The master answered, but not with success."""


class _TimedTransport(xmlrpc.client.Transport):
    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = _CALL_TIMEOUT
        return connection


def _call(uri: str, method: str, *arguments: str) -> Any:
    """Call the master API (wiki.ros.org/ROS/Master_API); its value, or MasterError when it reports a failure."""
    with xmlrpc.client.ServerProxy(uri, transport=_TimedTransport()) as master:
        answer: Any = getattr(master, method)(*arguments)
    code, text, value = answer
    if code != 1:
        raise MasterError(text)
    return value


def wait_for_master(uri: str, node: str, stop: threading.Event | None = None) -> bool:
    """Return True as soon as a ROS master answers at `uri`, or False once `stop` is set. Logs while it waits."""
    stop = stop or threading.Event()
    told = False
    while not stop.is_set():
        try:
            _call(uri, "getPid", f"/{node}")
            if told:
                _log.info("the ROS master at %s answers", uri)
            return True
        except (*_UNREACHABLE, MasterError) as error:
            if not told:
                _log.warning("no ROS master at %s (%s): waiting; start roscore, or set ROS_MASTER_URI", uri, error)
                told = True
        stop.wait(0.3)
    return False


class MasterWatch:
    """Calls `on_lost(reason)` once, from its own thread, when the master has lost the node `node`.

    The watch leaves a mark with the master, the private parameter `/<node>/alive_mark`. A restarted master does not
    know it (process IDs say nothing: in a container it is always 1), and another node of the same name replaces it.
    A master that does not answer for `patience` seconds is lost as well.
    """

    def __init__(
        self, uri: str, node: str, on_lost: Callable[[str], None], period: float = 1.0, patience: float = 3.0
    ) -> None:
        self._uri = uri
        self._node = f"/{node}"
        self._key = f"/{node}/alive_mark"
        self._mark = uuid.uuid4().hex
        self._on_lost = on_lost
        self._period = period
        self._patience = patience
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="master-watch", daemon=True)

    def start(self) -> None:
        """Leave the mark and watch. Call it before `rospy.init_node`, so that no restart goes unseen.

        OSError when the master cannot be reached.
        """
        try:
            _call(self._uri, "setParam", self._node, self._key, self._mark)
        except (http.client.HTTPException, xmlrpc.client.Error, MasterError) as error:
            raise OSError(f"the ROS master at {self._uri} failed: {error}") from error
        self._thread.start()

    def stop(self) -> None:
        """End the watch; `on_lost` is not called any more."""
        self._stop.set()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(_CALL_TIMEOUT + 0.5)

    def _run(self) -> None:
        answered = time.monotonic()
        while not self._stop.wait(self._period):
            try:
                found = _call(self._uri, "getParam", self._node, self._key)
            except MasterError:
                return self._lost("the ROS master was restarted and does not know this node any more")
            except _UNREACHABLE as error:
                if time.monotonic() - answered >= self._patience:
                    return self._lost(f"the ROS master at {self._uri} does not answer any more ({error})")
            else:
                answered = time.monotonic()
                if found != self._mark:
                    return self._lost(f"another node has taken the name {self._node}")

    def _lost(self, reason: str) -> None:
        if not self._stop.is_set():
            self._on_lost(reason)
