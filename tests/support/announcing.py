"""Announcements of any kind, true or false, as raw packets of multicast DNS: what server.announcer would never say.

    python -m tests.support.announcing ARENA ADDRESS... [--web 5000] [--ros 11311] [--version 1.0.0] ...
    python -m tests.support.announcing --nonsense 10000

They are sent every 0.2 s until the program is ended, nonsense once.
"""

import argparse
import contextlib
import random
import socket
import time

from zeroconf import DNSAddress, DNSOutgoing, DNSPointer, DNSService, DNSText
from zeroconf.const import (
    _CLASS_IN,
    _CLASS_UNIQUE,
    _FLAGS_AA,
    _FLAGS_QR_RESPONSE,
    _TYPE_A,
    _TYPE_PTR,
    _TYPE_SRV,
    _TYPE_TXT,
)

from laser_bot_battle.announcement import SERVICE
from laser_bot_battle.names import VERSION

MULTICAST_DNS = ("224.0.0.251", 5353)
PERIOD = 0.2  # s
TTL = 120  # s
OWN = _CLASS_IN | _CLASS_UNIQUE


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("arena", nargs="?")
    parser.add_argument("addresses", nargs="*")
    parser.add_argument("--web", type=int, default=5000)
    parser.add_argument("--rosbridge", default="9090")
    parser.add_argument("--ros", default="11311")
    parser.add_argument("--version", default=VERSION)
    parser.add_argument("--target", help="the host's name")
    parser.add_argument("--nonsense", type=int, default=0, help="announcements, and as many broken packets")
    options = parser.parse_args()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sender.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 255)
        sender.bind(("", MULTICAST_DNS[1]))
        for packet in nonsense(options.nonsense):
            sender.sendto(packet, MULTICAST_DNS)
            time.sleep(0.0002)  # as fast as a socket's buffer takes them
        print("announcing", flush=True)
        while True:
            for packet in announcement(options) if options.arena else []:
                with contextlib.suppress(OSError):  # the cable is out
                    sender.sendto(packet, MULTICAST_DNS)
            time.sleep(PERIOD)


def announcement(options: argparse.Namespace) -> list[bytes]:
    """The packets that announce what the options say."""
    name = f"{options.arena}.{SERVICE}"
    target = options.target or f"host-of-{options.addresses[0] if options.addresses else 'none'}.local."
    keys = {"version": options.version, "rosbridge": options.rosbridge, "ros": options.ros}
    return response(
        DNSPointer(SERVICE, _TYPE_PTR, _CLASS_IN, TTL, name),
        DNSService(name, _TYPE_SRV, OWN, TTL, 0, 0, options.web, target),
        DNSText(name, _TYPE_TXT, OWN, TTL, text(**{key: value for key, value in keys.items() if value})),
        *(DNSAddress(target, _TYPE_A, OWN, TTL, socket.inet_aton(address)) for address in options.addresses),
    )


def nonsense(number: int) -> list[bytes]:
    """So many announcements that say nothing useful, and as many packets that are none."""
    chance = random.Random(1)
    packets = []
    for count in range(number):
        name = f"nonsense {count}.{SERVICE}"
        packets += response(
            DNSPointer(SERVICE, _TYPE_PTR, _CLASS_IN, TTL, name),
            DNSText(name, _TYPE_TXT, OWN, TTL, text(version=chance.choice(["7.0.0", "<b>", "\x1b[2J"]))),
        )
        packets.append(chance.randbytes(chance.randrange(1, 200)))
        packets.append(packets[-2][: chance.randrange(1, len(packets[-2]))])
    return packets


def text(**keys: str) -> bytes:
    words = [f"{key}={value}".encode() for key, value in keys.items()]
    return b"".join(bytes([len(word)]) + word for word in words)


def response(*records: DNSPointer | DNSService | DNSText | DNSAddress) -> list[bytes]:
    packet = DNSOutgoing(_FLAGS_QR_RESPONSE | _FLAGS_AA)
    for record in records:
        packet.add_answer_at_time(record, 0)
    return packet.packets()


if __name__ == "__main__":
    main()
