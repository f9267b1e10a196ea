"""The ROS side of the device's services: those that it offers, and those that it calls.

Requests and answers bear no number on the serial line, so of each service one call at a time is under way.
"""

import logging
import queue
import threading
from collections.abc import Callable
from typing import Any

import rospy

from robot.rosserial.events import ServiceInfo
from robot.serial.device_topics import deserialised, serialised
from robot.serial.message_types import service_class
from robot.task_thread import TaskThread

ANSWER_TIMEOUT = 10.0  # s
MAX_CALLS = 4  # of the device, that wait for their turn; ros_lib makes one at a time

_log = logging.getLogger(__name__)

Send = Callable[[int, bytes], None]  # id and payload, to the device


class ServedService:
    """ROS calls it, the device answers; ValueError if it has a type that cannot be."""

    def __init__(self, info: ServiceInfo, send: Send) -> None:
        self._info = info
        self._send = send
        self._kind = service_class(info)
        self._turn = threading.Lock()
        self._answer: queue.SimpleQueue[bytes] | None = None  # of the call that is under way
        self._service = rospy.Service(info.name, self._kind, self._called)
        self.name = self._service.resolved_name

    def receive(self, payload: bytes) -> None:
        """The device's answer. One that nobody waits for any more is dropped."""
        answer = self._answer
        if answer is None:
            _log.warning("answer of the device's service %s dropped: it is late", self.name)
        else:
            answer.put(payload)

    def close(self) -> None:
        self._service.shutdown("the device tells another service")

    def _called(self, request: Any) -> Any:
        payload = serialised(request)
        if len(payload) > self._info.buffer_size:
            raise rospy.ServiceException(f"{len(payload)} bytes are more than the device's {self._info.buffer_size}")
        with self._turn:
            self._answer = queue.SimpleQueue()
            try:
                self._send(self._info.request_id, payload)
                answer = self._answer.get(timeout=ANSWER_TIMEOUT)
            except queue.Empty:
                raise rospy.ServiceException(f"the device has not answered within {ANSWER_TIMEOUT:g} s") from None
            finally:
                self._answer = None
        response = deserialised(self._kind._response_class, answer, self.name)
        if response is None:
            raise rospy.ServiceException("the device's answer is broken")
        return response


class CalledService:
    """The device calls it, ROS answers; ValueError if it has a type that cannot be.

    A call that fails gets no answer, which the protocol does not know: the log says why.
    """

    def __init__(self, info: ServiceInfo, send: Send) -> None:
        self._info = info
        self._send = send
        self._kind = service_class(info)
        self._proxy = rospy.ServiceProxy(info.name, self._kind)
        self._calls = TaskThread(f"calls {info.name}", MAX_CALLS)
        self.name = self._proxy.resolved_name

    def receive(self, payload: bytes) -> None:
        """The device's request."""
        request = deserialised(self._kind._request_class, payload, self.name)
        if request is not None and not self._calls.do(lambda: self._call(request)):
            _log.warning("call of %s by the device dropped: %d others wait", self.name, MAX_CALLS)

    def close(self) -> None:
        self._proxy.close()

    def _call(self, request: Any) -> None:
        try:
            payload = serialised(self._proxy(request))
        except (rospy.ServiceException, rospy.ROSException) as error:
            _log.warning("call of %s by the device failed: %s", self.name, error)
            return
        if len(payload) > self._info.buffer_size:
            _log.warning(
                "answer of %s dropped: %d bytes are more than the device's %d",
                self.name,
                len(payload),
                self._info.buffer_size,
            )
            return
        self._send(self._info.answer_id, payload)
