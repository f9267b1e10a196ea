"""Where a robot or a bot finds the master: as its settings say, else as the network does."""

import asyncio
import contextlib
import socket
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self
from urllib.parse import urlsplit

from laser_bot_battle import search, variables
from laser_bot_battle.announcement import Announcement, UnheardError
from laser_bot_battle.names import MASTER_HOST, ROS_PORT

NAME_ANSWER = 1.5  # s for a name server


@dataclass(frozen=True)
class Place:
    """The master's programs. `arena` is its name where it was found by its announcement, else ""."""

    host: str
    web: int
    ros_master_uri: str
    arena: str = ""
    rosbridge: int | None = None  # None: nobody has announced it
    source: str = field(default="", compare=False)  # who says so, for people

    def __str__(self) -> str:
        what = f"arena {self.arena!r}" if self.arena else "master"
        return f"{what} at {self.host}, {self.source}"

    @classmethod
    def given(cls, env: Mapping[str, str]) -> Self | None:
        """The place that the settings give, by LASERBOT_MASTER or else by ROS_MASTER_URI; None if they do not.

        SettingsError for an impossible value, also of a port that is of no use then.
        """
        host, source = variables.MASTER.read(env), variables.MASTER.name
        if not host and env.get(variables.ROS_MASTER_URI.name):
            host = urlsplit(variables.ROS_MASTER_URI.read(env)).hostname or ""
            source = variables.ROS_MASTER_URI.name
        place = cls.at(host or MASTER_HOST, env, f"as {source} says")
        return place if host else None

    @classmethod
    def at(cls, host: str, env: Mapping[str, str], source: str) -> Self:
        """On `host`, at the ports that the settings say."""
        return cls(
            host=host,
            web=variables.WEB.read(env),
            ros_master_uri=variables.ROS_MASTER_URI.read(env, default=f"http://{host}:{ROS_PORT}"),
            source=source,
        )

    @classmethod
    def announced(cls, announcement: Announcement, address: str) -> Self:
        """Where an arena says that it is; `address` is the one of its that answers."""
        return cls(
            host=address,
            web=announcement.web,
            ros_master_uri=f"http://{address}:{announcement.ros}",
            arena=announcement.arena,
            rosbridge=announcement.rosbridge,
            source="announced",
        )

    def environment(self) -> dict[str, str]:
        """The variables that tell a child process the same."""
        return {
            variables.MASTER.name: self.host,
            variables.WEB.name: str(self.web),
            variables.ROS_MASTER_URI.name: self.ros_master_uri,
        }


async def locate(env: Mapping[str, str], arena: str) -> Place:
    """The master's place: as given, else the arena's that announces itself, else by the name that the manual gives it.

    `arena` is the arena's name, "" for the only one. NoArenaError when there is none.
    """
    given = Place.given(env)
    if given:
        return given
    try:
        return Place.announced(*await search.find(arena))
    except UnheardError:
        # where multicast does not pass, the name may be known to DNS
        if arena or not await _is_known(MASTER_HOST):
            raise
        return Place.at(MASTER_HOST, env, "by its usual host name, because no arena announces itself in this network")


async def find_again(arena: str, lost: Place | None) -> Place:
    """The arena of that name, as soon as it is announced and answers. Waits for ever.

    `lost` is where it was: as long as a ROS master answers there, nothing else is taken.
    """
    url = urlsplit(lost.ros_master_uri) if lost else None
    had = (url.hostname or "", url.port or ROS_PORT) if url else None
    return Place.announced(*await search.find_again(arena, had))


async def _is_known(host: str) -> bool:
    """Whether it has an address. Nobody waits for a name server that is out of reach: not even the end of the loop."""
    answers: list[object] = []

    def ask() -> None:
        with contextlib.suppress(OSError):
            answers.extend(socket.getaddrinfo(host, None, socket.AF_INET))

    asking = threading.Thread(target=ask, name="host name", daemon=True)
    asking.start()
    end = time.monotonic() + NAME_ANSWER
    while asking.is_alive() and time.monotonic() < end:
        await asyncio.sleep(0.05)
    return bool(answers)
