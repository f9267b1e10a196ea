"""Which of a machine's networks robots and players are in: a table of machines."""

import socket
from dataclasses import replace
from typing import Any

import pytest

from laser_bot_battle import netlink
from laser_bot_battle.interfaces import Interface, LanAddress, UnknownInterfaceError, choose

RAW = 65534  # ARPHRD_NONE
LOOPBACK = Interface(1, "lo", (LanAddress("127.0.0.1", 8, "lo"),), layer=772, is_loopback=True)


def interface(index: int, name: str, *addresses: str, **what: Any) -> Interface:
    own = [address.partition("/") for address in addresses]
    return replace(Interface(index, name, tuple(LanAddress(ip, int(size), name) for ip, _, size in own)), **what)


def hardware(index: int, name: str, *addresses: str, **what: Any) -> Interface:
    return interface(index, name, *addresses, is_hardware=True, **what)


ETHERNET = hardware(2, "eth0", "192.168.1.5/24", metric=100)
WIFI = hardware(3, "wlan0", "192.168.4.1/24")
OF_A_CONTAINER = interface(4, "eth0", "172.17.0.2/16", kind="veth", below=9, leads_out=True, metric=0)
WIREGUARD = interface(5, "wg0", "10.8.0.2/32", kind="wireguard", layer=RAW, is_single=True)
TUN = interface(6, "tun0", "10.9.0.2/24", kind="tun", layer=RAW, is_single=True, metric=0)
MODEM = hardware(7, "wwan0", "100.70.0.9/30", is_modem=True, metric=50)
STICK = hardware(8, "usb0", "192.168.8.100/24", metric=50)
DOCKER = interface(10, "arcade", "172.18.0.1/16", kind="bridge")
PORT = interface(11, "veth1", kind="veth", below=2, leads_out=True, master=10)
OF_A_VM = interface(12, "vnet0", kind="tun", master=10)
HOST_ONLY = interface(13, "vboxnet0", "192.168.56.1/24")
INNER = interface(14, "inside", "10.33.0.9/24", kind="veth", below=15)
OVERLAY = interface(16, "flannel.1", "10.42.0.0/32", kind="vxlan", below=2)
DUMMY = interface(17, "kube-ipvs0", "10.43.0.1/32", kind="dummy", is_single=True)

MACHINES = {
    "one network": ([ETHERNET], ["192.168.1.5"]),
    "a VPN as default route": ([replace(ETHERNET, metric=None), TUN, WIREGUARD], ["192.168.1.5"]),
    "two networks, the one with a gateway first": ([WIFI, ETHERNET], ["192.168.1.5", "192.168.4.1"]),
    "two gateways, the nearer first": ([ETHERNET, replace(WIFI, metric=50)], ["192.168.4.1", "192.168.1.5"]),
    "a 4G stick that is a modem": ([MODEM, WIFI], ["192.168.4.1"]),
    "a 4G stick that is a router": ([WIFI, STICK], ["192.168.8.100", "192.168.4.1"]),
    "a public address after a private one": (
        [hardware(2, "eth0", "9.9.9.9/24", metric=0), WIFI],
        ["192.168.4.1", "9.9.9.9"],
    ),
    "an address that nobody gave": ([hardware(2, "eth0", "169.254.3.4/16"), WIFI], ["192.168.4.1", "169.254.3.4"]),
    "engines of containers and virtual machines": (
        [DOCKER, PORT, OF_A_VM, HOST_ONLY, INNER, OVERLAY, DUMMY, ETHERNET],
        ["192.168.1.5"],
    ),
    "an engine without a network": ([DOCKER, PORT, OF_A_VM, HOST_ONLY, INNER, OVERLAY], []),
    "a bridge with a radio": (
        [interface(20, "br0", "10.42.0.1/24", kind="bridge"), hardware(3, "wlan0", master=20), DOCKER],
        ["10.42.0.1"],
    ),
    "a bridge over a bond's VLAN": (
        [
            interface(20, "br0", "10.5.0.1/24", kind="bridge"),
            interface(21, "bond0.5", kind="vlan", below=22, master=20),
            interface(22, "bond0", kind="bond"),
            hardware(23, "eth1", master=22),
            hardware(24, "eth2", master=22),
        ],
        ["10.5.0.1"],
    ),
    "a VLAN of a container's network": ([interface(20, "v", "10.5.0.1/24", kind="vlan", below=10), DOCKER, PORT], []),
    "layers in a circle": (
        [interface(20, "a", "10.5.0.1/24", kind="vlan", below=21), interface(21, "b", kind="vlan", below=20)],
        [],
    ),
    "a container": ([OF_A_CONTAINER], ["172.17.0.2"]),
    "a container with a VPN": ([replace(OF_A_CONTAINER, metric=None), TUN], ["172.17.0.2"]),
    "a container of an engine without root": (
        [interface(2, "tap0", "10.0.2.100/24", kind="tun", metric=0)],
        ["10.0.2.100"],
    ),
    "a machine of containers whose way out is a bridge": (
        [
            interface(20, "br0", "10.5.0.1/24", kind="bridge", metric=0),
            replace(OF_A_CONTAINER, addresses=(), master=20, metric=None),
        ],
        ["10.5.0.1"],
    ),
    "a container with the network of its machine": (
        [interface(2, "eth0", "10.5.0.1/24", kind="macvlan", below=2, leads_out=True)],
        ["10.5.0.1"],
    ),
    "no cable, but a radio": ([replace(ETHERNET, has_carrier=False), WIFI], ["192.168.4.1"]),
    "no cable": ([replace(ETHERNET, has_carrier=False), TUN, DOCKER], ["192.168.1.5"]),
    "down": ([replace(ETHERNET, is_up=False), DOCKER], []),
    "a VPN while the LAN's address changes": ([replace(ETHERNET, addresses=()), TUN], []),
    "a VPN only": ([TUN, DOCKER], ["10.9.0.2"]),
    "nothing": ([], []),
}


@pytest.mark.parametrize(("interfaces", "taken"), MACHINES.values(), ids=MACHINES)
def test_the_networks_that_count(interfaces: list[Interface], taken: list[str]) -> None:
    choice = choose([LOOPBACK, *interfaces])
    assert [address.ip for address in choice.taken] == taken
    others = {address.ip for each in interfaces for address in each.addresses} - set(taken)
    assert {address.ip for address, why in choice.left_out if why} == others


def test_names_decide_nothing() -> None:
    assert [a.ip for a in choose([replace(ETHERNET, name="docker0"), replace(DOCKER, name="eth0")]).taken] == [
        "192.168.1.5"
    ]


def test_a_line_of_a_log_says_which_and_why() -> None:
    assert str(choose([LOOPBACK, ETHERNET, TUN, DOCKER, replace(WIFI, has_carrier=False)])) == (
        "192.168.1.5 on eth0 (real networks); left out: "
        "10.9.0.2 on tun0, leads to one peer, as a VPN or a modem does; "
        "172.18.0.1 on arcade, leads to this machine's containers or virtual machines only; "
        "192.168.4.1 on wlan0, has no cable or radio"
    )
    assert str(choose([LOOPBACK])) == "none (no network)"


@pytest.mark.parametrize(
    ("words", "taken"),
    [
        (["tun0"], ["10.9.0.2"]),
        (["192.168.4.1"], ["192.168.4.1"]),
        (["192.168.4.0/24", "eth0"], ["192.168.4.1", "192.168.1.5"]),
        (["192.168.0.0/16"], ["192.168.1.5", "192.168.4.1"]),
        (["arcade", "172.18.0.1"], ["172.18.0.1"]),
        (["eth9"], []),
    ],
)
def test_what_is_chosen_counts_whatever_it_is(words: list[str], taken: list[str]) -> None:
    choice = choose([LOOPBACK, ETHERNET, WIFI, TUN, DOCKER, hardware(30, "eth9")], words)
    assert [address.ip for address in choice.taken] == taken


@pytest.mark.parametrize("word", ["eth7", "192.168.9.1", "10.0.0.0/24", "fd00::1", "no/where", "lo"])
def test_what_is_not_there_is_an_error_that_says_what_is(word: str) -> None:
    with pytest.raises(UnknownInterfaceError) as error:
        choose([LOOPBACK, ETHERNET, TUN, hardware(30, "eth9")], ["eth0", word])
    assert str(error.value) == (
        f"there is no interface, address or network {word!r} on this machine; "
        "there is 192.168.1.5 on eth0, 10.9.0.2 on tun0, eth9"
    )


def test_the_kernel_names_all_interfaces_of_this_machine() -> None:
    found = netlink.interfaces()
    assert {(each.index, each.name) for each in found} == set(socket.if_nameindex())
    (loopback,) = (each for each in found if each.is_loopback)
    assert (loopback.name, loopback.is_hardware) == ("lo", False)
