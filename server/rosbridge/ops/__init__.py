"""The operations of the rosbridge protocol, one family per file. A new family is a file here and a line below."""

from server.rosbridge.ops.auth import Auth
from server.rosbridge.ops.family import Family
from server.rosbridge.ops.publishing import Publishing
from server.rosbridge.ops.services import Services
from server.rosbridge.ops.status import Status
from server.rosbridge.ops.subscribing import Subscribing

FAMILIES: tuple[type[Family], ...] = (
    Auth,
    Publishing,
    Services,
    Status,
    Subscribing,
)
