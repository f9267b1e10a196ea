"""Where a node of the own client sends a subscriber from another network of its machine."""

import asyncio

import pytest

from laser_bot_battle.arrival import Arrival, current
from laser_bot_battle.interfaces import LanAddress
from tcpros import slave_api
from tcpros.publisher import Publisher
from tcpros.slave_api import SlaveApi
from tcpros.specs import TypeSpec
from tcpros.subscriber import Subscriber

OWN = [LanAddress("10.9.0.1", 24), LanAddress("192.168.4.1", 24)]
COMMAND = TypeSpec("laser_bot_battle/Robot_msg", "*", "")


class Served:
    """A node at 10.9.0.1 that publishes commands."""

    master_uri = "http://10.9.0.1:11311"
    tcpros_address = ("10.9.0.1", 4567)

    def publishers(self) -> list[Publisher]:
        return [Publisher("/Robot0/command", COMMAND, False, False, lambda _: None)]

    def subscribers(self) -> list[Subscriber]:
        return []

    def publisher_update(self, topic: str, publishers: list[str]) -> None:
        pass

    def shut_down(self, reason: str) -> None:
        pass


@pytest.mark.parametrize(
    ("caller", "came_by", "told"),
    [
        ("10.9.0.7", "10.9.0.1", "10.9.0.1"),
        ("192.168.4.7", "192.168.4.1", "192.168.4.1"),
        ("127.0.0.1", "127.0.0.1", "10.9.0.1"),
    ],
)
def test_a_subscriber_is_sent_to_the_address_by_which_it_came(
    monkeypatch: pytest.MonkeyPatch, caller: str, came_by: str, told: str
) -> None:
    monkeypatch.setattr(slave_api, "own_networks", lambda: OWN)

    async def ask() -> object:
        current.set(Arrival(caller, came_by))
        return SlaveApi(Served()).handle("requestTopic", ("/Robot0", "/Robot0/command", [["TCPROS"]]))

    assert asyncio.run(ask()) == (1, f"ready on {told}:4567", ["TCPROS", told, 4567])
