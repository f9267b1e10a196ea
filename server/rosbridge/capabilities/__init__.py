"""The operations of the rosbridge protocol, one family per file. A new family is a file here and a line below."""

from server.rosbridge.capabilities.auth import Auth
from server.rosbridge.capabilities.capability import Family
from server.rosbridge.capabilities.publishing import Publishing
from server.rosbridge.capabilities.services import Services
from server.rosbridge.capabilities.status import Status
from server.rosbridge.capabilities.subscribing import Subscribing

FAMILIES: tuple[type[Family], ...] = (
    Auth,
    Publishing,
    Services,
    Status,
    Subscribing,
)
