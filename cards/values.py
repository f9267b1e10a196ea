"""What a setting of laserbot.txt may be. Each function returns it as the card uses it; ValueError says what is
allowed."""

import base64
import binascii
import difflib
import re
from collections.abc import Collection

ROLES = ("robot", "master")
PREVIOUS = "previous"
VERSIONS = ("newest", PREVIOUS)
MOVE = "move"
SECRETS = ("keep", MOVE)


def role(text: str, own: str) -> str:
    if text.lower() not in ROLES:
        raise ValueError(f"must be {' or '.join(ROLES)}")
    if text.lower() != own:
        raise ValueError(f"this is a {own}'s card; a {text.lower()}'s is made from laserbot-{text.lower()}.img.xz")
    return own


def host_name(text: str) -> str:
    if not re.fullmatch(r"[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?", text.lower()):
        raise ValueError("must be at most 63 letters (a to z), digits and -, which is neither first nor last")
    return text.lower()


def wifi(text: str) -> str:
    if len(text.encode()) > 32:
        raise ValueError("must be at most 32 bytes, as every Wi-Fi's name is")
    return text


def wifi_password(text: str) -> str:
    # printable ASCII is all that WPA knows; 64 digits are the key itself
    if not re.fullmatch(r"[ -~]{8,63}|[0-9a-fA-F]{64}", text):
        raise ValueError("must be 8 to 63 letters (a to z), digits and signs, or 64 hexadecimal digits")
    return text


def country(text: str) -> str:
    if not re.fullmatch(r"[a-zA-Z]{2}", text) or text.upper() == "UK":
        raise ValueError("must be the two letters of ISO 3166, such as DE, GB or US")
    return text.upper()


def zone(text: str, zones: Collection[str]) -> str:
    known = {zone.lower(): zone for zone in zones}
    wanted = re.sub(r"\s+", "_", text.lower())
    if wanted in known:
        return known[wanted]
    # many write only the city
    nearest = difflib.get_close_matches(wanted, known, 1) or [
        zone
        for city in difflib.get_close_matches(wanted, sorted({zone.rpartition("/")[2] for zone in known}), 1)
        for zone in sorted(known)
        if zone.rpartition("/")[2] == city
    ]
    raise ValueError(f"there is no such time zone{f'; the nearest is {known[nearest[0]]}' if nearest else ''}")


def ssh_key(text: str) -> str:
    kind, _, rest = text.partition(" ")
    try:
        content = base64.b64decode(rest.partition(" ")[0], validate=True)
    except binascii.Error:
        content = b""
    # a key begins with the length and the name of its kind
    if not re.fullmatch(r"(ssh|ecdsa|sk)-[\w@.-]+", kind) or content[:4] + content[4 : 4 + len(kind)] != (
        len(kind).to_bytes(4, "big") + kind.encode()
    ):
        raise ValueError("must be a whole public key in one line, such as ssh-ed25519 AAAA... me@my-computer")
    return text


def camera(text: str) -> str:
    if text.lower() == "libcamera":
        # Debian's kernel is built without CONFIG_VIDEO_BCM2835_UNICAM
        raise ValueError("the card's kernel has no driver for the Raspberry Pi's own camera: use a USB camera")
    if not re.fullmatch(r"/dev/[\w/.-]+", text):
        raise ValueError("must be a device such as /dev/video0")
    return text


def version(text: str) -> str:
    if text.lower() not in VERSIONS:
        raise ValueError(f"must be {' or '.join(VERSIONS)}")
    return text.lower()


def secrets(text: str) -> str:
    if text.lower() not in SECRETS:
        raise ValueError(f"must be {' or '.join(SECRETS)}")
    return text.lower()
