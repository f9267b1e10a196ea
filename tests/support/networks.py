"""Machines as people have them: in two networks, with a VPN, with containers and virtual machines. Needs root."""

from tests.support.lan import Lan, Machine

VPN = "10.8.0.2"


def vpn(machine: Machine, address: str = VPN) -> None:
    """A VPN that takes all that leaves the LAN, as most do."""
    machine.ip("tuntap", "add", "tun0", "mode", "tun")
    machine.ip("addr", "add", f"{address}/24", "dev", "tun0")
    machine.ip("link", "set", "tun0", "up")
    machine.ip("route", "replace", "default", "via", "10.8.0.1")


def containers(machine: Machine) -> None:
    """The bridges of Docker, of one of its named networks and of LXD, with a container in the last; VirtualBox's own
    network, by the kind of interface that comes nearest."""
    for name, address in (("docker0", "172.17.0.1/16"), ("arcade", "172.18.0.1/16"), ("lxdbr0", "10.33.0.1/24")):
        machine.ip("link", "add", name, "type", "bridge")
        machine.ip("addr", "add", address, "dev", name)
        machine.ip("link", "set", name, "up")
    machine.ip("link", "add", "inside", "type", "veth", "peer", "name", "veth7")
    for end in ("veth7", "inside"):
        machine.ip("link", "set", end, "up")
    machine.ip("link", "set", "veth7", "master", "lxdbr0")
    machine.ip("addr", "add", "10.33.0.9/24", "dev", "inside")
    machine.ip("tuntap", "add", "vboxnet0", "mode", "tap")
    machine.ip("addr", "add", "192.168.56.1/24", "dev", "vboxnet0")
    machine.ip("link", "set", "vboxnet0", "up")


def stick(machine: Machine) -> None:
    """A 4G stick that is a router: the way into the internet, with a network of its own for this machine alone."""
    machine.ip("link", "add", "usb0", "type", "veth", "peer", "name", "inside-stick")
    machine.ip("addr", "add", "192.168.8.100/24", "dev", "usb0")
    for end in ("usb0", "inside-stick"):
        machine.ip("link", "set", end, "up")
    machine.ip("route", "replace", "default", "via", "192.168.8.1")


def second_network(lan: Lan, machine: Machine, name: str = "wlan0") -> Machine:
    """Another machine, in a network of its own with this one: 192.168.4.1 is the machine, 192.168.4.2 the other."""
    other = lan.machine()
    other.ip("link", "set", "eth0", "down")
    other.ip("link", "del", "eth0")
    machine.ip("link", "add", name, "type", "veth", "peer", "name", "wlan0", "netns", str(other.pid))
    for each, number, end in ((machine, 1, name), (other, 2, "wlan0")):
        each.ip("addr", "add", f"192.168.4.{number}/24", "dev", end)
        each.ip("link", "set", end, "up")
    return other
