"""Every LASERBOT_ variable of the system, in the order in which people need them: docs/settings.md shows this list.

    python3 -m laser_bot_battle.variables     prints its table

"Not with compose" means that compose.yaml itself sets the variable, or that it makes no sense there.
"""

import re
from ipaddress import IPv4Network, IPv6Network, ip_network
from pathlib import Path

from laser_bot_battle.announcement import MAX_OWN_NAME
from laser_bot_battle.arena_list import ListedArena, read_arenas
from laser_bot_battle.floor import NAMES, is_floor
from laser_bot_battle.names import (
    CAMERA_STREAM_PORT,
    ENTRANCE_PORT,
    METRICS_PORT,
    RELAY_PORT,
    ROBOT_IDS,
    ROS_PORT,
    ROSBRIDGE_PORT,
    ROSSERIAL_PORT,
    WATCHED,
    WEB_PORT,
    client_name,
)
from laser_bot_battle.settings import (
    LOG_LEVELS,
    Variable,
    choice,
    flag,
    globs,
    number,
    port,
    whole,
    words,
)

MAX_FIRST_PORT = 65536 - len(WATCHED)
SHORTEST_TOKEN = 16  # characters; fewer could be guessed, as nothing slows that down
DATABASES = "postgresql://user:password@host/name or sqlite:////folder/file"
_HEADER_GPIOS = range(28)  # the others belong to the Raspberry Pi's own parts, such as its SD card


def _roster(text: str) -> dict[str, int]:
    """The IDs by the robots' ROS names, from `name=ID` words between spaces or commas."""
    fixed: dict[str, int] = {}
    for word in re.split(r"[\s,]+", text.strip()) if text.strip() else []:
        name, _, robot_id = word.rpartition("=")
        if not name or not re.fullmatch(r"[0-9]{1,3}", robot_id) or int(robot_id) not in ROBOT_IDS:
            raise ValueError(f"{word!r} is not name=ID with an ID from 0 to {ROBOT_IDS[-1]}")
        client = client_name(name)
        if client in fixed or int(robot_id) in fixed.values():
            raise ValueError(f"{word!r} repeats a name or an ID")
        fixed[client] = int(robot_id)
    return fixed


def _robot_ids(text: str) -> tuple[int, ...]:
    found = [word for word in re.split(r"[\s,]+", text) if word]
    if not all(re.fullmatch(r"[0-9]{1,3}", word) and int(word) in ROBOT_IDS for word in found):
        raise ValueError(f"must be IDs of robots, from 0 to {ROBOT_IDS[-1]}, with spaces between")
    return tuple(dict.fromkeys(map(int, found)))


def _gpio(text: str) -> int | None:
    if text == "none":
        return None
    if not re.fullmatch(r"[0-9]{1,2}", text) or int(text) not in _HEADER_GPIOS:
        raise ValueError(f"must be a GPIO from 0 to {_HEADER_GPIOS[-1]}, or none")
    return int(text)


def _teams(text: str) -> int:
    if text not in ("0", "2", "3", "4"):
        raise ValueError("must be 0, 2, 3 or 4")
    return int(text)


def _floor(text: str) -> str:
    if not is_floor(text):
        raise ValueError(f"must be {', '.join(NAMES)} or the path of a floor's file (.json)")
    return text


def _separated(text: str) -> tuple[str, ...]:
    return tuple(text.split())


def _devices(text: str) -> tuple[str, ...]:
    devices = tuple(text.split())
    if "tcp-listen:" in text:
        match = re.fullmatch(r"tcp-listen://([^:\[\]/\s]*|\[[0-9a-fA-F:.]+\]):([0-9]{1,5})", text)
        if not match or not 0 < int(match[2]) < 2**16:
            raise ValueError(f"must be tcp-listen://address:port alone, such as tcp-listen://:{ROSSERIAL_PORT}")
    return devices


def _origins(text: str) -> tuple[str, ...]:
    origins = tuple(text.lower().split())
    for origin in origins:
        if not re.fullmatch(r"https?://([a-z0-9._-]+|\[[0-9a-f:.]+\])(:[0-9]{1,5})?", origin):
            raise ValueError(f"{origin!r} is not http://host, http://host:port or the like with https")
    return origins


def _domain(text: str) -> str:
    if not re.fullmatch(r"\*|[a-z0-9-]+(\.[a-z0-9-]+)*", text.lower()):
        raise ValueError("must be a domain such as arena.example, or *")
    return text.lower()


def _networks(text: str) -> tuple[IPv4Network | IPv6Network, ...]:
    try:
        return tuple(ip_network(word) for word in text.split())
    except ValueError as error:
        raise ValueError(f"must be addresses or networks such as 10.42.0.0/16: {error}") from None


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([0-9]{2,4})x([0-9]{2,4})", text)
    if not match:
        raise ValueError("must be width x height, such as 640x480")
    return int(match[1]), int(match[2])


def _camera_url(text: str) -> str:
    if not re.fullmatch(r"http://[^/\s]+:[0-9]{1,5}(/[\w/.-]*)?", text):
        raise ValueError("must be http://host:port or http://host:port/path")
    return text.rstrip("/")


def _stream_url(text: str) -> str:
    if not re.fullmatch(r"http://([\w.-]+|\[[0-9a-fA-F:.]+\])(:[0-9]{1,5})?(/[!-~]*)?", text, re.ASCII):
        raise ValueError("must be http://host:port or http://host:port/path, without a user's name")
    return text


def _address(text: str) -> tuple[str, int]:
    address, _, port_text = text.rpartition(":")
    if not address or not re.fullmatch(r"[0-9]{1,5}", port_text) or not 1 <= int(port_text) <= MAX_FIRST_PORT:
        raise ValueError(f"must be address:port, such as 127.0.0.1:{METRICS_PORT}, with a port up to {MAX_FIRST_PORT}")
    return address.strip("[]"), int(port_text)


def _arena(text: str) -> str:
    too_long = len(text.encode("utf-8", "replace")) > MAX_OWN_NAME
    if not text.isprintable() or "." in text or text.startswith("_") or too_long:
        raise ValueError(f"must be a name of at most {MAX_OWN_NAME} bytes without dots, and not begin with _")
    return text.strip()


def _token(text: str) -> str:
    if len(text) < SHORTEST_TOKEN:
        raise ValueError(f"the token needs at least {SHORTEST_TOKEN} characters: make one by openssl rand -hex 16")
    return text


def _database(text: str) -> str:
    if not re.match(r"(postgresql(\+pg8000)?|sqlite)://", text):
        raise ValueError(f"must be {DATABASES}")
    return text


def _master_uri(text: str) -> str:
    match = re.fullmatch(r"http://[^/:]+:([0-9]{1,5})/?", text)
    if not match or not 0 < int(match[1]) < 2**16:
        raise ValueError("must be http://host:port")
    return text


BIND = words(
    "LASERBOT_BIND",
    "0.0.0.0",
    "address on which the web server, rosbridge, the cameras' relay, the front and the arena listen. `0.0.0.0`: all of "
    "this machine's addresses, IPv6 included; `127.0.0.1`: for programs on this machine only, also at `::1`",
    "`0.0.0.0` (demo: `127.0.0.1`)",
)
INTERFACE: Variable[tuple[str, ...]] = Variable(
    "LASERBOT_INTERFACE",
    (),
    "the network of robots and players, if it is not [found](discovery.md#which-network): an interface's name, an "
    "address of this machine or a network, such as `wlan0` or `192.168.1.0/24`; several with spaces between them",
    _separated,
    "each real network",
)
WEB = port("LASERBOT_WEB_PORT", WEB_PORT, "the game's pages")
ROSBRIDGE = port("LASERBOT_ROSBRIDGE_PORT", ROSBRIDGE_PORT, "rosbridge's WebSocket")
RELAY = port("LASERBOT_RELAY_PORT", RELAY_PORT, "where browsers get the pictures of the robots' [cameras](cameras.md)")
HTTP = port("LASERBOT_HTTP_PORT", 80, "[the one address](front.md) of the whole game")
HTTPS = port("LASERBOT_HTTPS_PORT", 443, "the same by TLS, if there is a certificate")
TLS = words(
    "LASERBOT_TLS",
    "",
    "folder with a certificate for TLS: `front.crt` and `front.key` in PEM, and `ca.crt` of an authority of your own",
)
RELAY_VIEWERS = whole(
    "LASERBOT_RELAY_VIEWERS", 200, 1, 10_000, "people who may look through cameras at once; one more is refused"
)
RELAY_RATE = whole(
    "LASERBOT_RELAY_RATE", 200, 1, 10_000, "Mbit/s of all pictures together; beyond it spectators get fewer of them"
)
ORIGINS: Variable[tuple[str, ...]] = Variable(
    "LASERBOT_ORIGINS",
    (),
    "further addresses at which people open the game's pages, such as [a proxy's](front.md): `https://arena.example`, "
    "with spaces between them",
    _origins,
    "none",
    pattern=r"(?i)(https?://[^\s/]+(\s+|$))*",
)
DOMAIN: Variable[str] = Variable(
    "LASERBOT_DOMAIN",
    "",
    "what [several arenas and their entrance](scale.md) have in common, so that a player has one name and one session "
    "in all: a domain such as `arena.example`; `*`: the host by which each is asked, where they differ by port",
    _domain,
    "none: each arena on its own",
)
ENTRANCE = port("LASERBOT_ENTRANCE_PORT", ENTRANCE_PORT, "[the entrance](scale.md) to several arenas")
ARENAS: Variable[tuple[ListedArena, ...]] = Variable(
    "LASERBOT_ARENAS",
    (),
    "the arenas that the entrance leads to: a name, where browsers find it (a port of the entrance's own host, or an "
    "address), and if it differs where the entrance asks, such as `red=:30510 blue=https://blue.example@10.0.0.7:5000`",
    read_arenas,
    "none",
)
PROXIES: Variable[tuple[IPv4Network | IPv6Network, ...]] = Variable(
    "LASERBOT_PROXIES",
    (),
    "addresses and networks of proxies elsewhere before the game's ports, whose `X-Forwarded-For`, `-Host` and "
    "`-Proto` are believed; on this machine, all are",
    _networks,
    "none",
)
ROS = port("LASERBOT_ROS_PORT", ROS_PORT, "the ROS master that `make demo` starts; not with compose")
ARENA = port("LASERBOT_ARENA_PORT", 8080, "the virtual arena's own page, for developers")
ARENA_LINK = port("LASERBOT_ARENA_LINK_PORT", 8081, "the virtual robots' link to the arena; not with compose")
FLOOR: Variable[str] = Variable(
    "LASERBOT_FLOOR",
    "battle",
    "the floor: `battle`, with walls to hide behind, `duel`, small and open, each virtual robot face to face with "
    "another, or the path of [a file](floor.md)",
    _floor,
    "`battle`",
    pattern=rf"((?i:{'|'.join(NAMES)})|.*/.*|.*[.]json)",
)
BOT_ROBOTS: Variable[tuple[int, ...]] = Variable(
    "LASERBOT_BOT_ROBOTS",
    (),
    "robots that [bots](operator.md#bots) drive while nobody else wants them, by their IDs: `2 3`; operators may "
    "decide otherwise. `make demo` has `BOTS` instead",
    _robot_ids,
    "none",
    pattern=r"([0-9]{1,3}([\s,]+|$))*",
)
BOT_LEVEL = choice("LASERBOT_BOT_LEVEL", "easy", ("easy", "fair", "hard"), "how good these bots are")
HIT_DAMAGE = whole("LASERBOT_HIT_DAMAGE", 10, 1, 100, "life (of 100) that a hit takes")
LIGHT = choice(
    "LASERBOT_LIGHT",
    "plain",
    ("plain", "coded"),
    "what a shot is: light alone, or a code that says whose",
    "`plain` (demo: `coded`)",
)
TEAMS: Variable[int] = Variable(
    "LASERBOT_TEAMS",
    0,
    "teams that fight, 2 to 4; 0: everybody fights alone",
    _teams,
    "0",
    lowest=0,
    highest=4,
    pattern="[0234]",
)
FRIENDLY_FIRE = flag("LASERBOT_FRIENDLY_FIRE", "1: hits from the same team count, too")
LIGHT_DAMAGE = flag("LASERBOT_LIGHT_DAMAGE", "1: a hit by coded light takes what its code says, not the usual damage")
HIDE_CAMERAS = flag(
    "LASERBOT_HIDE_CAMERAS", "1: while a battle runs, spectators do not see through the robots' cameras"
)
HANDICAP = whole(
    "LASERBOT_HANDICAP",
    0,
    0,
    90,
    "percent of a hit's damage that it does not take from a player who has lost three battles in a row; 0: none",
)
COUNTDOWN = number("LASERBOT_COUNTDOWN", 15, 0.1, 3600, "seconds of countdown once two players are ready")
BATTLE_LIMIT = number(
    "LASERBOT_BATTLE_LIMIT", 300, 1, 86400, "seconds until a battle ends; then whoever has the most life wins"
)
PROTECTION = number(
    "LASERBOT_PROTECTION", 3, 0, 60, "seconds from the start of a battle in which nobody can be hit; 0: none"
)
PLAYER_TIMEOUT = number(
    "LASERBOT_PLAYER_TIMEOUT", 15, 1, 86400, "seconds without a sign of life until a player is out of a battle"
)
SEAT_TIMEOUT = number(
    "LASERBOT_SEAT_TIMEOUT", 60, 1, 86400, "the same without a battle: how long a phone that sleeps keeps its robot"
)
IDLE = number(
    "LASERBOT_IDLE", 60, 1, 86400, "seconds without being ready until a player loses the robot to somebody who waits"
)
OFFER = number("LASERBOT_OFFER", 20, 1, 3600, "seconds that somebody who has waited has to take the robot")
BATTLES_IN_ROW = whole(
    "LASERBOT_BATTLES_IN_ROW", 3, 0, 1000, "battles until a player loses the robot to somebody who waits; 0: never"
)
SEAT_MINUTES = number(
    "LASERBOT_SEAT_MINUTES",
    0,
    0,
    1440,
    "minutes until a player loses the robot to somebody who waits, though not in a battle; 0: never",
)
SEATS = whole("LASERBOT_SEATS", 0, 0, len(ROBOT_IDS), "robots that players may have at once; 0: all")
PRACTICE = flag("LASERBOT_PRACTICE", "1: players may drive while neither countdown nor battle runs", default=True)
PRACTICE_BESIDE = flag(
    "LASERBOT_PRACTICE_BESIDE", "1: who has a robot and is not in the battle may drive while it runs, without shooting"
)
LATE_JOIN = flag(
    "LASERBOT_LATE_JOIN",
    "1: who has a robot may still join a battle without teams that runs, with the life of its weakest living fighter",
)
FENCE = flag(
    "LASERBOT_FENCE",
    "1: a robot that would leave the floor stops at its edge, as far as `/positions` tells where it is",
)
HILL = flag(
    "LASERBOT_HILL",
    "1: each second that a fighter, or a team, is alone on one of the floor's hills is a point, and most points win",
)
PICKUPS = number(
    "LASERBOT_PICKUPS",
    0,
    0,
    3600,
    "seconds after which a repair, a shield or double damage lies at each of the floor's places for it, for whoever "
    "drives over it first; 0: never",
)
LINE_OF_FIRE = number(
    "LASERBOT_LINE_OF_FIRE",
    0,
    0,
    50,
    "metres that a robot's light reaches: by `/positions`, a coded hit counts only if the shooter stood no farther "
    "away, looked that way, and no wall was between; 0: from anywhere",
)
DATA: Variable[Path] = Variable(
    "LASERBOT_DATA",
    Path("~/.local/share/laserbot"),
    "folder for `laserbot.db`, the database: who plays, robots' IDs, battles; "
    "not with compose, which has a volume for it",
    Path,
    "`~/.local/share/laserbot`",
)
DATABASE: Variable[str] = Variable(
    "LASERBOT_DATABASE",
    "",
    "another database: `postgresql://user:password@host/name`, or `sqlite:///` and a file",
    _database,
    "`laserbot.db`",
    is_secret=True,
)
BACKUPS = whole(
    "LASERBOT_BACKUPS",
    14,
    1,
    1000,
    "days for which each day's newest [backup](results.md#back-up-and-restore) is kept; of the last day, as many",
)
BACKUP_VOLUME = words(
    "LASERBOT_BACKUP_VOLUME",
    "",
    "where compose's service `backup` writes them: a folder, by an absolute path, that the user 10001 may write to",
    "a volume of its own",
)
ROSTER: Variable[dict[str, int]] = Variable(
    "LASERBOT_ROSTER",
    {},
    "robots with fixed IDs, by their `LASERBOT_ROBOT_NAME`: `raspberrypi1=1 raspberrypi2=2`; "
    "any other robot gets the lowest free ID and keeps it",
    _roster,
    "none",
    pattern=r"([^\s,]+=[0-9]{1,3}([\s,]+|$))*",
)
OPERATOR_TOKEN: Variable[str] = Variable(
    "LASERBOT_OPERATOR_TOKEN",
    "",
    "secret of [the operators](operator.md), at least 16 characters: it opens their desk and lets a rosbridge client "
    "do everything",
    _token,
    "none",
    is_secret=True,
)
OPERATOR_TOKEN_FILE = words(
    "LASERBOT_OPERATOR_TOKEN_FILE", "", "file that holds this secret, instead of the secret itself; not with compose"
)
OPEN = flag(
    "LASERBOT_ROSBRIDGE_OPEN",
    "1: rosbridge lets everybody do everything, as the manual's did. For a lab; anyone who gets to the port then "
    "drives every robot",
)
TOPICS_GLOB = globs("LASERBOT_TOPICS_GLOB", "topics that rosbridge's clients may use: `/scan,/camera/*`")
SERVICES_GLOB = globs("LASERBOT_SERVICES_GLOB", "services that rosbridge's clients may call or offer")
PARAMS_GLOB = globs("LASERBOT_PARAMS_GLOB", "parameters that rosbridge's clients may use, by `/rosapi`")
ARENA_NAME: Variable[str] = Variable(
    "LASERBOT_ARENA",
    "",
    "name by which the master announces itself in its network, and which robots and bots join; arenas that share a "
    "PostgreSQL database are told apart by it",
    _arena,
    "the master's host name; for robots and bots, the only arena that there is",
)
MASTER = words(
    "LASERBOT_MASTER",
    "",
    "host name or address at which a robot or a bot finds the master",
    "the arena that [announces itself](discovery.md)",
)
SERIAL: Variable[tuple[str, ...]] = Variable(
    "LASERBOT_SERIAL",
    ("/dev/laserbot", "/dev/ttyACM0", "/dev/ttyUSB0"),
    "the Arduino: paths to try in this order, or a pyserial URL such as `socket://host:port`; or "
    f"`tcp-listen://:{ROSSERIAL_PORT}`, for [boards with Wi-Fi](build-a-robot.md#a-robot-without-a-raspberry-pi)",
    _devices,
    "`/dev/laserbot /dev/ttyACM0 /dev/ttyUSB0`",
)
ROBOT_NAME = words("LASERBOT_ROBOT_NAME", "", "name by which the server knows a robot", "host name and MAC address")
RETRY = number(
    "LASERBOT_RETRY",
    5,
    0.1,
    3600,
    "longest pause, in seconds, between a robot's attempts to find its Arduino and the master; it begins at 0.2",
)
IMAGES = words("LASERBOT_IMAGES", "", "what compose puts before the images' names: `registry:port/`")
VERSION = words("LASERBOT_VERSION", "", "the images' tag for compose", "this version")
LED: Variable[int | None] = Variable(
    "LASERBOT_LED",
    18,
    "GPIO of a robot's [status LED](lan.md#the-status-led), or `none`",
    _gpio,
    "18",
)
CAMERA = words(
    "LASERBOT_CAMERA",
    "",
    "a robot's [camera](cameras.md): its device, such as `/dev/video0`, or `libcamera` for the Raspberry Pi's own",
)
CAMERA_SIZE: Variable[tuple[int, int]] = Variable(
    "LASERBOT_CAMERA_SIZE", (640, 480), "width and height of its pictures", _size, "640x480"
)
CAMERA_RATE = whole("LASERBOT_CAMERA_RATE", 20, 1, 60, "pictures a second")
CAMERA_QUALITY = whole(
    "LASERBOT_CAMERA_QUALITY", 80, 1, 100, "quality of the JPEGs, where the camera does not make them itself"
)
CAMERA_PORT = port(
    "LASERBOT_CAMERA_PORT", CAMERA_STREAM_PORT, "on a robot, where the master gets the camera's pictures"
)
CAMERA_URL: Variable[str] = Variable(
    "LASERBOT_CAMERA_URL",
    "",
    "where this robot's pictures are, if another program has them: `http://host:port/path`",
    _camera_url,
    "none",
)
OVERHEAD_CAMERA: Variable[str] = Variable(
    "LASERBOT_OVERHEAD_CAMERA",
    "",
    "[the camera above the floor](overhead-camera.md), by whose pictures robots get places: where its ustreamer is, "
    "such as `http://192.168.1.30:8090`, or the whole address of another MJPEG stream",
    _stream_url,
    "none",
)
OVERHEAD_HEIGHT = number("LASERBOT_OVERHEAD_HEIGHT", 2.5, 0.5, 20, "how high that camera is over the floor, in m")
OVERHEAD_TAG_HEIGHT = number(
    "LASERBOT_OVERHEAD_TAG_HEIGHT", 0.11, 0, 0.4, "how high the robots' tags are over the floor, in m"
)
GPIO = words("LASERBOT_GPIO", "", "GPIO device that compose gives to a robot: `/dev/gpiochip0`")
GPIO_GROUP = words("LASERBOT_GPIO_GROUP", "", "number of the group that may use the GPIO: `getent group gpio`")
ALIVE_FILE = words(
    "LASERBOT_ALIVE_FILE", "", "file that a working program touches every second, for health checks; not with compose"
)
PRIORITY: Variable[int] = Variable(
    "LASERBOT_PRIORITY",
    1,
    "real-time [priority](lan.md#priority) that rosbridge, the serial node and the simulator take where the system "
    "grants it; 0: none. With compose, what the engine grants them",
    whole("LASERBOT_PRIORITY", 1, 0, 99, "").parse,
    "1 (compose: 0)",
    lowest=0,
    highest=99,
)
JOURNAL = words(
    "LASERBOT_JOURNAL",
    "",
    "folder of systemd's journals, such as `/var/log/journal`, whose newest lines [the desk](operator.md) shows; by "
    "Ansible it has the logs of all hosts; not with compose",
)
METRICS: Variable[tuple[str, int] | None] = Variable(
    "LASERBOT_METRICS",
    None,
    "address and port at which the web server [can be watched](monitoring.md); rosbridge, the cameras' relay, the "
    "arena and the camera above the floor have the next ports. "
    f"`127.0.0.1:{METRICS_PORT}`: for programs on this machine only",
    _address,
    f"none (compose: `127.0.0.1:{METRICS_PORT}`)",
)
ALERTMANAGER = words(
    "LASERBOT_ALERTMANAGER",
    "",
    "a file of your own that says whom compose's [Alertmanager](monitoring.md) notifies, by an absolute path",
)
LOG_LEVEL = choice("LASERBOT_LOG_LEVEL", "info", LOG_LEVELS, "how much is logged")
LOG_FORMAT = choice(
    "LASERBOT_LOG_FORMAT", "text", ("text", "json"), "lines of log for people, or [for programs](monitoring.md#logs)"
)

# ROS's own; a robot takes the default from its master's name
ROS_MASTER_URI: Variable[str] = Variable(
    "ROS_MASTER_URI", f"http://localhost:{ROS_PORT}", "the ROS master", _master_uri, f"port {ROS_PORT} of the master"
)

LASERBOT = tuple(v for v in list(globals().values()) if isinstance(v, Variable) and v.name.startswith("LASERBOT_"))


def table() -> str:
    """The Markdown table of all variables."""
    rows = [f"| `{variable.name}` | {variable.shown} | {variable.text} |" for variable in LASERBOT]
    return "\n".join(["| variable | default | what |", "|---|---|---|", *rows]) + "\n"


if __name__ == "__main__":
    print(table(), end="")
