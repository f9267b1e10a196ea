"""A rospy publisher for commands to robots: they leave at once, and a robot that does not read holds nobody up.

rospy offers to send in `publish` itself, which blocks as long as one robot does not read, or from a thread per robot,
which costs more than all the rest of a command's way through rosbridge.
"""

import socket
from typing import Any

import rospy

# What the kernel may hold for a robot that does not read: the commands of about a second, so that after a short
# disturbance of the radio the last one, neutral perhaps, gets through.
BUFFER = 16 * 2**10  # bytes


def command_publisher(topic: str, message_class: type[Any]) -> rospy.Publisher:
    """A publisher whose `publish` sends at once, or drops the message for those robots that do not read. Never latched:
    a robot that joins must not act on an old command.

    A message that is dropped is made up for by the next one, or by the robot's own stop after a silence. (To close the
    connection instead would be the end of it: a rospy subscriber does not connect again.)
    """
    listener = NewSubscribers()
    publisher = rospy.Publisher(topic, message_class, listener, tcp_nodelay=True, queue_size=1)
    publisher.impl.set_queue_size(None)  # no thread; as an argument above, None would bring a warning
    listener.publisher = publisher
    listener.peer_subscribe()
    return publisher


class NewSubscribers(rospy.SubscribeListener):  # type: ignore[misc]
    """Called by rospy for each new subscriber; makes the connections send or drop."""

    publisher: rospy.Publisher | None = None

    def peer_subscribe(self, *_: Any) -> None:
        for connection in self.publisher.impl.connections if self.publisher else ():
            if not isinstance(connection.write_data, SendOrDrop):
                connection.write_data = SendOrDrop(connection.socket)


class SendOrDrop:
    """Stands in for `write_data` of one connection."""

    def __init__(self, connected: socket.socket) -> None:
        self._socket = connected
        self._rest = b""  # of a message that was sent in part
        connected.setblocking(False)
        connected.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER)

    def __call__(self, data: bytes) -> bool:
        """OSError when the connection is lost, upon which rospy forgets it."""
        try:
            if self._rest:
                self._rest = self._rest[self._socket.send(self._rest) :]
            if not self._rest:
                self._rest = data[self._socket.send(data) :]
        except BlockingIOError:
            pass  # full: this message is dropped
        return True
