"""Asks the server for this robot's ID, by the service /add_new_robot (manual 3.1.2).

The request is empty. The server knows a robot by what stands in the connection's header: its name and, as `KEY_FIELD`,
the digest of the key that its pings will show.
"""

import asyncio
import struct
import threading
import time
from collections.abc import Callable, Mapping
from queue import Empty, SimpleQueue

from laser_bot_battle.master import MasterError
from laser_bot_battle.names import ADD_NEW_ROBOT, KEY_FIELD, key_digest
from tcpros import xmlrpc_client
from tcpros.service_call import ServiceCaller
from tcpros.specs import ServiceError

ADD_NEW_ROBOT_MD5 = "0cb5143ed23a5de01874507c8711c4d5"  # of laser_bot_battle/AddNewRobot
WAIT = 4.0  # s for a server that is just starting
CONNECT = 1.0  # s; after a change of address the ROS master may still name the server's old one
MASTER_TIMEOUT = 10.0  # s
ANSWER_TIMEOUT = 15.0  # s for the whole call, once the server takes connections
GIVE_UP = 30.0  # s for everything, name servers included
POLL = 0.05  # s

_RESPONSE = struct.Struct("<b")


class RegistrationError(Exception):
    """The server gave no ID; the text says why."""


def register(master_uri: str, caller_id: str, key: str, wanted: Callable[[], bool]) -> int:
    """This robot's ID. RegistrationError says why there is none.

    `caller_id` is the robot's ROS name. Gives up as soon as `wanted` says no: the question then ends unheard, in a
    thread of its own, because nothing can interrupt a name server that is out of reach.
    """
    answers: SimpleQueue[int | RegistrationError] = SimpleQueue()

    def ask() -> None:
        try:
            answers.put(asyncio.run(_ask(master_uri, caller_id, key)))
        except (OSError, ServiceError) as error:
            answers.put(RegistrationError(f"Service call failed: {error} (ROS master {master_uri})"))

    threading.Thread(target=ask, name="registration", daemon=True).start()
    end = time.monotonic() + GIVE_UP
    while time.monotonic() < end:
        if not wanted():
            raise RegistrationError("not needed any more")
        try:
            answer = answers.get(timeout=POLL)
        except Empty:
            continue
        if isinstance(answer, RegistrationError):
            raise answer
        if answer < 0:
            raise RegistrationError(f"the server answered with the ID {answer}")
        return answer
    raise RegistrationError(f"no answer from the ROS master or the server within {GIVE_UP:g} s")


async def _ask(master_uri: str, caller_id: str, key: str) -> int:
    async def master(method: str, *arguments: str) -> object:
        code, text, value = await xmlrpc_client.call(master_uri, method, caller_id, *arguments, timeout=MASTER_TIMEOUT)
        if code != 1:
            raise MasterError(text)
        return value

    server = ServiceCaller(caller_id, master)
    await _wait_for(server)
    header = {KEY_FIELD: key_digest(key)}
    response, _ = await server.call(ADD_NEW_ROBOT, _empty, ANSWER_TIMEOUT, ADD_NEW_ROBOT_MD5, header)
    try:
        (robot_id,) = _RESPONSE.unpack(response)
    except struct.error:
        raise ServiceError(f"a response of {len(response)} bytes") from None
    return int(robot_id)


async def _empty(_header: Mapping[str, str]) -> bytes:
    return b""


async def _wait_for(server: ServiceCaller) -> None:
    """Until it takes connections, or does not for WAIT s: the call itself then says best what is wrong."""
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        try:
            await server.probe(ADD_NEW_ROBOT, CONNECT)
        except ServiceError:
            await asyncio.sleep(2 * POLL)
        else:
            return
