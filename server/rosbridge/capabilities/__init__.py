"""The operations of the rosbridge protocol, one capability per file. A new one is a file here and a line below."""

from server.rosbridge.capabilities.auth import Auth
from server.rosbridge.capabilities.capability import Capability
from server.rosbridge.capabilities.publishing import Publishing
from server.rosbridge.capabilities.service_offers import ServiceOffers
from server.rosbridge.capabilities.services import Services
from server.rosbridge.capabilities.status import Status
from server.rosbridge.capabilities.subscribing import Subscribing
from server.rosbridge.capabilities.wrapping import Wrapping

CAPABILITIES: tuple[type[Capability], ...] = (
    Auth,
    Publishing,
    ServiceOffers,
    Services,
    Status,
    Subscribing,
    Wrapping,
)
