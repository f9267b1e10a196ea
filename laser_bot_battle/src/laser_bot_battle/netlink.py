"""This machine's network interfaces, as the Linux kernel tells them (rtnetlink(7)), whose names for the numbers stand
beside them. Anybody may ask, and a container hears of its own interfaces only, which /sys does not promise.
"""

import ipaddress
import os
import socket
import struct
from collections.abc import Iterator
from pathlib import Path

from laser_bot_battle.interfaces import Interface, LanAddress

_TIMEOUT = 2.0  # s
_LARGEST = 2**16  # bytes of one answer
_HEADER = struct.Struct("=IHHII")  # nlmsghdr: length, type, flags, number, port
_ATTRIBUTE = struct.Struct("=HH")  # rtattr: length, type
_LINK = struct.Struct("=BxHiII")  # ifinfomsg: family, layer, index, flags, change
_ADDRESS = struct.Struct("=BBBBI")  # ifaddrmsg: family, prefix, flags, scope, index
_ROUTE = struct.Struct("=BBBBBBBBI")  # rtmsg: family, prefix, source's prefix, tos, table, protocol, scope, type, flags
_NUMBER = struct.Struct("=I")
_DUMP = 0x301  # NLM_F_REQUEST | NLM_F_DUMP
_ERROR, _DONE = 2, 3  # NLMSG_ERROR, NLMSG_DONE
_GET_LINK, _GET_ADDRESS, _GET_ROUTE = 18, 22, 26  # RTM_GETLINK, RTM_GETADDR, RTM_GETROUTE
_UP, _LOOPBACK, _POINT_TO_POINT, _NO_ARP, _LOWER_UP = 1, 8, 0x10, 0x80, 0x10000  # IFF_*
_NAME, _BELOW, _MASTER, _INFO, _OTHER_NAMESPACE, _PARENT = 3, 5, 10, 18, 37, 56  # IFLA_*
_KIND = 1  # IFLA_INFO_KIND
_PEER, _LOCAL = 1, 2  # IFA_ADDRESS, IFA_LOCAL
_OUT, _GATEWAY, _PRIORITY = 4, 5, 6  # RTA_OIF, RTA_GATEWAY, RTA_PRIORITY
_SCOPE_HOST = 254  # RT_SCOPE_HOST
_MAIN_TABLE = 254  # RT_TABLE_MAIN
_NESTED = 0x3FFF  # the type of an attribute, without its flags
_DEVICES = Path("/sys/class/net")


def interfaces() -> list[Interface]:
    """All of them. OSError when the kernel does not tell."""
    with socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE) as kernel:
        kernel.settimeout(_TIMEOUT)
        kernel.bind((0, 0))
        links = list(_dump(kernel, _GET_LINK, _LINK))
        addresses = list(_dump(kernel, _GET_ADDRESS, _ADDRESS))
        routes = list(_dump(kernel, _GET_ROUTE, _ROUTE))
    return [_interface(fields, attributes, addresses, routes) for fields, attributes in links]


def own_networks() -> list[LanAddress]:
    """All IPv4 addresses of this machine, with their networks; none if the kernel does not tell."""
    try:
        return [address for interface in interfaces() for address in interface.addresses]
    except OSError:
        return []


_Message = tuple[tuple[int, ...], dict[int, bytes]]


def _interface(
    link: tuple[int, ...], attributes: dict[int, bytes], addresses: list[_Message], routes: list[_Message]
) -> Interface:
    _, layer, index, flags, _ = link
    name = _text(attributes.get(_NAME, b""))
    kind = _text(dict(_attributes(attributes.get(_INFO, b""))).get(_KIND, b""))
    device = _device(name, index) if not kind else None
    return Interface(
        index=index,
        name=name,
        addresses=tuple(_addresses(name, index, addresses)),
        kind=kind,
        is_hardware=_PARENT in attributes or device is not None,
        layer=layer,
        is_up=bool(flags & _UP),
        has_carrier=bool(flags & _LOWER_UP),
        is_loopback=bool(flags & _LOOPBACK),
        is_single=bool(flags & (_POINT_TO_POINT | _NO_ARP)),
        is_modem=kind == "wwan" or (device is not None and "DEVTYPE=wwan" in device),
        master=_number(attributes, _MASTER),
        below=_number(attributes, _BELOW),
        leads_out=_OTHER_NAMESPACE in attributes,
        metric=min(_metrics(index, routes), default=None),
    )


def _addresses(name: str, index: int, addresses: list[_Message]) -> Iterator[LanAddress]:
    for (_, prefix, _, scope, owner), attributes in addresses:
        packed = attributes.get(_LOCAL) or attributes.get(_PEER)
        if owner == index and packed and scope < _SCOPE_HOST:
            yield LanAddress(str(ipaddress.IPv4Address(packed)), prefix, name)


def _metrics(index: int, routes: list[_Message]) -> Iterator[int]:
    for (_, prefix, _, _, table, *_), attributes in routes:
        is_default = prefix == 0 and table == _MAIN_TABLE and _GATEWAY in attributes
        if is_default and _number(attributes, _OUT) == index:
            yield _number(attributes, _PRIORITY)


def _device(name: str, index: int) -> list[str] | None:
    """What /sys says about the interface's device; None if it has none, or /sys is of another network namespace.
    Kernels before 5.14 do not tell the device otherwise, and none tells modems."""
    folder = _DEVICES / name
    try:
        if int((folder / "ifindex").read_text()) == index and (folder / "device").exists():
            return (folder / "uevent").read_text().split()
    except (OSError, ValueError):
        pass
    return None


def _dump(kernel: socket.socket, kind: int, head: struct.Struct) -> Iterator[_Message]:
    """All that the kernel has of one kind, of IPv4: what stands in front, and the attributes by their types."""
    request = bytes([socket.AF_INET if kind != _GET_LINK else socket.AF_UNSPEC]).ljust(head.size, b"\0")
    kernel.send(_HEADER.pack(_HEADER.size + len(request), kind, _DUMP, kind, 0) + request)
    while True:
        answer = kernel.recv(_LARGEST)
        while len(answer) >= _HEADER.size:
            length, what, _, number, _ = _HEADER.unpack_from(answer)
            message, answer = answer[_HEADER.size : length], answer[_aligned(length) :]
            if number != kind:
                continue  # of an earlier question
            if what == _DONE:
                return
            if what == _ERROR:
                code = -struct.unpack_from("=i", message)[0]
                raise OSError(code, os.strerror(code))
            yield head.unpack_from(message), dict(_attributes(message[_aligned(head.size) :]))


def _attributes(data: bytes) -> Iterator[tuple[int, bytes]]:
    while len(data) >= _ATTRIBUTE.size:
        length, kind = _ATTRIBUTE.unpack_from(data)
        if length < _ATTRIBUTE.size:
            return
        yield kind & _NESTED, data[_ATTRIBUTE.size : length]
        data = data[_aligned(length) :]


def _aligned(length: int) -> int:
    return -(-length // 4) * 4


def _number(attributes: dict[int, bytes], kind: int) -> int:
    value = attributes.get(kind, b"")
    return int(_NUMBER.unpack(value)[0]) if len(value) == _NUMBER.size else 0


def _text(value: bytes) -> str:
    return value.rstrip(b"\0").decode(errors="replace")
