"""What is said about types, and what can go wrong with services."""

from typing import Any, NamedTuple, Self

ANY = "*"  # in the place of a type's name or md5 sum: whatever the other side has


class TypeSpec(NamedTuple):
    """A message type. A subscriber may give ANY as name and md5 sum, and takes what the publisher has."""

    name: str
    md5sum: str
    definition: str

    @classmethod
    def of(cls, message: Any) -> Self:
        """Of a class that is generated for a message type."""
        return cls(message._type, message._md5sum, message._full_text)


class ServiceSpec(NamedTuple):
    name: str
    md5sum: str


class ServiceError(Exception):
    """A call of a service came to nothing; the text says why."""


class ServiceFailure(Exception):  # noqa: N818 - no error of this program
    """Raised by a service's handler: the text goes to the caller."""
