"""Which names of ROS a lab shows to rosbridge's clients (upstream's topics_glob, services_glob, params_glob)."""

from fnmatch import fnmatchcase
from typing import NamedTuple

Patterns = tuple[str, ...] | None


class Globs(NamedTuple):
    """Shell patterns of global names; `*` matches slashes, too. None, or no patterns at all: everything is allowed."""

    topics: Patterns = None
    services: Patterns = None
    params: Patterns = None

    def allows_topic(self, name: str) -> bool:
        return matches(name, self.topics)

    def allows_service(self, name: str) -> bool:
        """rosapi's own services are always allowed: they keep to the patterns themselves."""
        return name.startswith("/rosapi/") or matches(name, self.services)

    def allows_param(self, name: str) -> bool:
        return matches(name, self.params)


def matches(name: str, patterns: Patterns) -> bool:
    return not patterns or any(fnmatchcase(name, pattern) for pattern in patterns)
