"""The web server's HTTP interface, as a player's page uses it, and what it tells bots."""

import asyncio
import http.client
import json
import urllib.error
import urllib.request
from http.cookies import SimpleCookie
from typing import Any
from urllib.parse import urlencode

from laser_bot_battle.names import SESSION_COOKIE
from server.bots.mind import SKILLS

TIMEOUT = 3.0  # s

# never by a proxy of the environment's: the master is near
_opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))


class GameError(Exception):
    """The web server does not answer, or not as it should; the text says why."""


class Web:
    """One visitor's. Each call waits in a thread, and not in the event loop."""

    def __init__(self, url: str) -> None:
        self._url = url
        self._session = ""
        self._answered_at = asyncio.get_running_loop().time()

    @property
    def silence(self) -> float:
        """For how many s the server has not answered."""
        return asyncio.get_running_loop().time() - self._answered_at

    @property
    def cookies(self) -> dict[str, str]:
        """By header: they say to rosbridge, too, which player this is."""
        return {"Cookie": f"{SESSION_COOKIE}={self._session}"} if self._session else {}

    async def given(self, *, sees: bool) -> dict[int, str]:
        """The robots that operators give to bots, with the bots' level; `sees`: whether bots see robots now."""
        answer = await self._post("bots", sees=str(int(sees)))
        try:
            return {int(robot): level for robot, level in answer["robots"].items() if level in SKILLS}
        except (KeyError, AttributeError, TypeError, ValueError) as error:
            raise GameError(f"cannot understand which robots are for bots: {error!r}") from None

    async def look(self) -> tuple[set[int], set[str]]:
        """The robots that are free, and the names that are taken."""
        free, names = await self._post("getAvailableRobots", data="data"), await self._names()
        try:
            return {int(robot) for robot in free["robots"]}, names
        except (KeyError, TypeError, ValueError) as error:
            raise GameError(f"cannot understand which robots are free: {error!r}") from None

    async def sign_up(self, name: str, robot: int) -> dict[str, Any]:
        """As `name`, to drive that robot."""
        return await self._post("signUpUser", data=name, robot=str(robot))

    async def sign_out(self, name: str) -> dict[str, Any]:
        return await self._post("signOutUser", data=name)

    async def set_ready(self, name: str, ready: bool) -> dict[str, Any]:
        return await self._post("playerReady", user=name, ready=str(int(ready)))

    async def is_signed_in(self, name: str) -> bool:
        """Also a sign of life, which the server wants at least every 15 s."""
        return name in await self._names()

    async def _names(self) -> set[str]:
        """Of those who play."""
        status = await self._post("updateGameStatus", data="data")
        try:
            return {str(user["name"]) for user in json.loads(status["users"])}
        except (KeyError, TypeError, ValueError) as error:
            raise GameError(f"cannot understand the server's status: {error!r}") from None

    async def _post(self, call: str, **form: str) -> dict[str, Any]:
        """The JSON object that the server answers; GameError."""
        try:
            text, session = await asyncio.to_thread(self._ask, call, form)
        except (http.client.HTTPException, OSError) as error:
            reason = error.reason if isinstance(error, urllib.error.URLError) else error
            raise GameError(f"no game server at {self._url}: {reason or type(error).__name__}") from None
        try:
            answer = json.loads(text)
        except ValueError:
            answer = None
        if not isinstance(answer, dict):
            raise GameError(f"{call}: the answer of the server at {self._url} is not a JSON object")
        self._session = session or self._session
        self._answered_at = asyncio.get_running_loop().time()
        return answer

    def _ask(self, call: str, form: dict[str, str]) -> tuple[bytes, str]:
        """The answer, also of a refusal, and the session that it gives."""
        asked = urllib.request.Request(f"{self._url}/{call}", urlencode(form).encode(), self.cookies)
        try:
            response = _opener.open(asked, timeout=TIMEOUT)
        except urllib.error.HTTPError as refusal:
            response = refusal
        with response:
            cookies: SimpleCookie = SimpleCookie()
            for cookie in response.headers.get_all("Set-Cookie", ()):
                cookies.load(cookie)
            given = cookies.get(SESSION_COOKIE)
            return response.read(), given.value if given else ""
