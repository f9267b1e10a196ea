"""Who publishes, subscribes and serves what: the ROS master's getSystemState (wiki.ros.org/ROS/Master_API)."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Self

from server.websocket.requests import is_ros_name

ACTION_TOPICS = frozenset({"cancel", "feedback", "goal", "result", "status"})  # actionlib's

Nodes = Mapping[str, Sequence[str]]  # nodes by the name of what they use


class SystemState(NamedTuple):
    """Topics and services in use; each has at least one node."""

    publishers: Nodes
    subscribers: Nodes
    services: Nodes

    @classmethod
    def of(cls, answer: Sequence[Iterable[Any]]) -> Self:
        """`answer` is the master's: three lists of [name, nodes]."""
        publishers, subscribers, services = answer
        return cls(dict(publishers), dict(subscribers), dict(services))

    def topics(self) -> list[str]:
        return sorted({*self.publishers, *self.subscribers})

    def nodes(self) -> list[str]:
        return sorted({node for part in self for nodes in part.values() for node in nodes})


def shown(names: Nodes, allowed: Callable[[str], bool]) -> Nodes:
    """Those that clients can use, and may."""
    return {name: nodes for name, nodes in names.items() if is_ros_name(name) and allowed(name)}


def used_by(node: str, names: Nodes) -> list[str]:
    return sorted(name for name, nodes in names.items() if node in nodes)


def action_servers(topics: Iterable[str]) -> list[str]:
    """The namespaces that have all topics of an action."""
    found: dict[str, set[str]] = {}
    for topic in topics:
        namespace, _, name = topic.rpartition("/")
        found.setdefault(namespace, set()).add(name)
    return sorted(namespace for namespace, names in found.items() if namespace and names >= ACTION_TOPICS)
