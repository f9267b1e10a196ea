"""At which address ROS finds the master's programs, by what the machine's network looks like."""

from collections.abc import Callable

import pytest

from laser_bot_battle import addresses
from laser_bot_battle.interfaces import LanAddress
from server.program.ros_address import choose, successor

HERE = "http://localhost:11311"
Network = Callable[..., None]


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    """Gives this machine these addresses."""

    def has(*ips: str) -> None:
        lan = [LanAddress(ip, 24) for ip in ips]
        monkeypatch.setattr(addresses, "lan_addresses", lambda: lan)
        monkeypatch.setattr("server.program.ros_address.own_addresses", lambda: {"127.0.0.1", *ips})

    return has


@pytest.mark.parametrize("master_uri", [HERE, "http://127.0.0.1:11311", "http://127.0.1.1:11311"])
def test_beside_the_ros_master_it_is_the_first_of_the_network(network: Network, master_uri: str) -> None:
    network("10.9.0.1", "192.168.1.5")
    assert choose("0.0.0.0", master_uri) == "10.9.0.1"


def test_it_is_the_one_that_the_program_listens_on(network: Network) -> None:
    network("10.9.0.1", "192.168.1.5")
    assert choose("192.168.1.5", HERE) == "192.168.1.5"


@pytest.mark.parametrize("bind", ["127.0.0.1", "localhost", "::1"])
def test_a_program_for_this_machine_only_is_found_on_it(network: Network, bind: str) -> None:
    network("10.9.0.1")
    assert choose(bind, HERE) == "127.0.0.1"
    assert successor("127.0.0.1", bind, HERE) is None


def test_without_network_it_is_the_machines_own_until_there_is_one(network: Network) -> None:
    network()
    assert choose("0.0.0.0", HERE) == "127.0.0.1"
    assert successor("127.0.0.1", "0.0.0.0", HERE) is None
    network("10.9.0.1")
    assert successor("127.0.0.1", "0.0.0.0", HERE) == "10.9.0.1"


def test_an_unknown_master_is_an_error_that_names_it(network: Network) -> None:
    network("10.9.0.1")
    with pytest.raises(OSError, match=r"cannot reach the ROS master at nowhere\.invalid"):
        choose("0.0.0.0", "http://nowhere.invalid:11311")


def test_an_address_stays_while_the_machine_has_it_or_no_other(network: Network) -> None:
    network("10.9.0.2", "10.9.0.1")
    assert successor("10.9.0.1", "0.0.0.0", HERE) is None
    network()
    assert successor("10.9.0.1", "0.0.0.0", HERE) is None
    network("10.9.0.2")
    assert successor("10.9.0.1", "0.0.0.0", HERE) == "10.9.0.2"
