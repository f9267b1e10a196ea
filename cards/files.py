"""What the settings of a card become: files of its system."""

from pathlib import Path
from typing import NamedTuple

from cards.laserbot_txt import Card

STATE = Path("/var/lib/laserbot-card")  # what a card remembers
MASTER_HOST = "laser-bot-master"
HOST_NAME = "/etc/hostname"
USER = "pi"
OPERATOR_TOKEN = "/etc/laserbot/operator-token"  # which the master's containers read when they start
CONTAINER_USER = 10001


class File(NamedTuple):
    content: str
    mode: int = 0o644
    owner: str | int = "root"
    link: bool = False  # the content is where it leads


def host_name(card: Card) -> str | None:
    """The name in the network that the settings give, if they do."""
    return MASTER_HOST if card.role == "master" else card.name


def own_name(serial: str) -> str:
    """That of a robot that nobody has named: told apart by the end of its Raspberry Pi's serial number, which is in
    hexadecimal digits."""
    return f"raspberrypi-{serial[-6:] or '0'}"


def files(card: Card) -> dict[str, File]:
    """By path: the files that the settings decide. What they do not name is left to others."""
    found = {}
    if host := host_name(card):
        found[HOST_NAME] = File(f"{host}\n")
    if card.operator_token:
        found[OPERATOR_TOKEN] = File(card.operator_token, 0o400, CONTAINER_USER)
    if card.time_zone:
        found["/etc/localtime"] = File(f"/usr/share/zoneinfo/{card.time_zone}", link=True)
    if card.ssh_keys:
        found[f"/home/{USER}/.ssh/authorized_keys"] = File("".join(f"{key}\n" for key in card.ssh_keys), 0o600, USER)
    if card.wifi:
        found["/etc/wpa_supplicant/wpa_supplicant-wlan0.conf"] = File(_wifi(card, card.wifi), 0o600)
    return found


def _wifi(card: Card, name: str) -> str:
    """wpa_supplicant's configuration. The name is given in hexadecimal digits, as it may hold any character."""
    lines = [f"country={card.country}"] if card.country else []
    lines += ["network={", f"    ssid={name.encode().hex()}", "    scan_ssid=1"]
    if not card.wifi_password:
        lines += ["    key_mgmt=NONE"]
    else:
        is_key = len(card.wifi_password) == 64
        lines += ["    key_mgmt=WPA-PSK SAE", "    ieee80211w=1"]
        lines += [f"    psk={card.wifi_password}" if is_key else f'    psk="{card.wifi_password}"']
    return "\n".join([*lines, "}", ""])
