"""Tells the web server every 0.4 s that this robot is alive (manual: pingThread; behaviour of POST /incAlive)."""

import contextlib
import logging
import threading
import time

import requests

PERIOD = 0.4  # s
TIMEOUT = 1.0  # s for the connection, and again for the answer

_log = logging.getLogger(__name__)


class PingThread(threading.Thread):
    """Pings from start() to stop(), whatever the server does; a context manager does both, and says so when the program
    is interrupted."""

    def __init__(self, url: str, robot_id: int, key: str) -> None:
        """`key`: by which the server knows that a ping is this robot's."""
        super().__init__(name="pings", daemon=True)
        self.unknown = threading.Event()  # set when the server does not know this robot, or its key
        self._url = url
        self._robot_id = robot_id
        self._key = key
        self._end = threading.Event()
        self._reachable = True
        self._answered_at = time.monotonic()

    def __enter__(self) -> "PingThread":
        self.start()
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        self.stop()
        if kind is KeyboardInterrupt:
            self._say_goodbye()

    @property
    def welcome(self) -> bool:
        """Whether the server answers, and knows this robot."""
        return self._reachable and not self.unknown.is_set()

    @property
    def silence(self) -> float:
        """For how many s no ping has been answered."""
        return time.monotonic() - self._answered_at

    def stop(self) -> None:
        """No ping is sent after this; one on its way is not waited for."""
        self._end.set()

    def run(self) -> None:
        _log.info("pingThread starts: robot %d at %s", self._robot_id, self._url)
        with requests.Session() as session:
            session.trust_env = False  # the server is in the LAN: no proxy, no .netrc
            due = time.monotonic()
            while not self._end.wait(max(0.0, due - time.monotonic())):
                due = max(due + PERIOD, time.monotonic())  # pings missed in an outage are not made up for
                self._ping(session)
        _log.info("pingThread ends: robot %d", self._robot_id)

    def _ping(self, session: requests.Session) -> None:
        try:
            ping = {"ID": self._robot_id, "key": self._key}
            answer = session.post(self._url, data=ping, timeout=TIMEOUT, allow_redirects=False)
            if answer.status_code not in (requests.codes.ok, requests.codes.forbidden):
                raise ValueError(f"HTTP status {answer.status_code}")
            status = answer.json()["status"]
            if status not in ("OK", "ERROR"):
                raise ValueError(f"unknown status {status!r}")
        except (requests.RequestException, ValueError, KeyError, TypeError) as error:
            self._outage(f"{error}")
        except Exception as error:  # this thread is the robot's sign of life: nothing may end it silently
            _log.exception("ping failed unexpectedly")
            self._outage(f"{error!r}")
        else:
            if not self._reachable:
                _log.info("webserver answers again")
            self._reachable = True
            self._answered_at = time.monotonic()
            if status == "ERROR":
                self.unknown.set()

    def _say_goodbye(self) -> None:
        """The robot is switched off: nobody has to look for it. It goes without an answer, too."""
        self.join(TIMEOUT)  # a ping after this would say that it is back
        ping = {"ID": self._robot_id, "key": self._key, "leaving": "1"}
        with requests.Session() as session, contextlib.suppress(requests.RequestException):
            session.trust_env = False
            session.post(self._url, data=ping, timeout=TIMEOUT, allow_redirects=False)

    def _outage(self, reason: str) -> None:
        """Logged once per outage, not per ping."""
        if self._reachable and not self._end.is_set():
            _log.warning("Connection to webserver lost, trying again: %s", reason)
        self._reachable = False
