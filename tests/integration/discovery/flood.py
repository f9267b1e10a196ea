"""Nonsense for whoever listens: `python -m tests.integration.discovery.flood NUMBER`, so many packets of each kind."""

import random
import socket
import struct
import sys
import time

MULTICAST_DNS = ("224.0.0.251", 5353)
RESPONSE, QUESTION, CUT_QUESTION = 0x8400, 0, 0x0200
A, PTR, INTERNET = 1, 12, 1
FOR_EVER = 0x7FFFFFFF  # s


def main() -> None:
    chance = random.Random(1)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sender.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        sender.bind(("", MULTICAST_DNS[1]))
        for number in range(int(sys.argv[1])):
            service = label(b"_laserbot") + label(b"_tcp") + label(b"local") + b"\0"
            instance = label(b"nonsense %d" % number) + service
            host = label(b"host%d" % number) + label(b"local") + b"\0"
            answers = [record(service, PTR, instance), record(host, A, chance.randbytes(4))]
            packets = [
                packet(RESPONSE, answers=answers),
                packet(QUESTION, questions=[question(service, PTR), question(instance, 255)]),
                packet(CUT_QUESTION, questions=[question(instance, PTR)]),
                packet(RESPONSE, answers=answers)[: chance.randrange(12, 60)],
                chance.randbytes(chance.randrange(1, 200)),
            ]
            for each in packets:
                sender.sendto(each, MULTICAST_DNS)
            time.sleep(0.0005)  # about what a listener can take
    print("done", flush=True)


def label(text: bytes) -> bytes:
    return bytes([len(text)]) + text


def question(name: bytes, kind: int) -> bytes:
    return name + struct.pack("!HH", kind, INTERNET)


def record(name: bytes, kind: int, content: bytes) -> bytes:
    return name + struct.pack("!HHIH", kind, INTERNET, FOR_EVER, len(content)) + content


def packet(flags: int, questions: list[bytes] | None = None, answers: list[bytes] | None = None) -> bytes:
    questions, answers = questions or [], answers or []
    return struct.pack("!6H", 0, flags, len(questions), len(answers), 0, 0) + b"".join(questions + answers)


if __name__ == "__main__":
    main()
