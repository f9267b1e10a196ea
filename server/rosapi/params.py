"""rosapi's services for the ROS parameter server. Values travel as JSON text, since a parameter may be of any type."""

import json
from typing import Any

from laser_bot_battle.master import MasterError
from server.access.globs import Globs
from server.rosapi.handlers import Handler, Values, global_name, sendable
from server.rosapi.param_values import as_json, parameter
from server.websocket.requests import RequestError
from tcpros.node import Node


class Params:
    """A parameter that the globs hide cannot be changed, and for readers is not there."""

    def __init__(self, node: Node, globs: Globs) -> None:
        self._node = node
        self._globs = globs

    def handlers(self) -> dict[str, tuple[str, Handler]]:
        return {
            "set_param": ("SetParam", self.set_param),
            "get_param": ("GetParam", self.get_param),
            "has_param": ("HasParam", self.has_param),
            "search_param": ("SearchParam", self.search_param),
            "delete_param": ("DeleteParam", self.delete_param),
            "get_param_names": ("GetParamNames", self.get_param_names),
        }

    async def set_param(self, request: Values) -> Values:
        name = self._changeable(request["name"])
        await self._node.master("setParam", name, parameter(request["value"]))
        return {}

    async def get_param(self, request: Values) -> Values:
        """Without such a parameter the default, which may be JSON or any other text; null when that is empty."""
        name = global_name(request["name"])
        if self._globs.allows_param(name):
            try:
                return {"value": as_json(await self._node.master("getParam", name))}
            except MasterError:
                pass
        return {"value": as_json(_default(request["default"]))}

    async def has_param(self, request: Values) -> Values:
        return {"exists": await self._has(global_name(request["name"]))}

    async def search_param(self, request: Values) -> Values:
        """The name of the nearest parameter in the namespaces above, or an empty string."""
        try:
            found = await self._node.master("searchParam", sendable(request["name"]))
        except MasterError:
            return {"global_name": ""}
        return {"global_name": found if self._globs.allows_param(found) else ""}

    async def delete_param(self, request: Values) -> Values:
        """One that is not there is no error."""
        name = self._changeable(request["name"])
        if await self._has(name):
            await self._node.master("deleteParam", name)
        return {}

    async def get_param_names(self, _: Values) -> Values:
        names = await self._node.master("getParamNames")
        return {"names": [name for name in names if self._globs.allows_param(name)]}

    async def _has(self, name: str) -> bool:
        return self._globs.allows_param(name) and bool(await self._node.master("hasParam", name))

    def _changeable(self, given: str) -> str:
        name = global_name(given)
        if not self._globs.allows_param(name):
            raise RequestError(f"parameter {name} may not be changed here: it is not among those that are open")
        return name


def _default(text: str) -> Any:
    if not text:
        return None
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text
