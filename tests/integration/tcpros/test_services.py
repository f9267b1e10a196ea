"""Services between our node and rospy."""

import asyncio
import io
import socket
from collections.abc import Callable, Mapping

import pytest
from roscpp.srv import SetLoggerLevel, SetLoggerLevelRequest  # type: ignore[import-untyped]

from laser_bot_battle.srv import AddNewRobot, AddNewRobotResponse
from tcpros.service_call import MakeRequest
from tcpros.specs import ServiceError, ServiceFailure, ServiceSpec
from tests.integration.tcpros.conftest import Scenario, StartNode
from tests.integration.tcpros.ends import RawPeer, RospyPeer, eventually, registered
from tests.support.polling import LATEST
from tests.support.ros import HOST

Run = Callable[[Scenario], None]

SET_LEVEL = ServiceSpec("roscpp/SetLoggerLevel", SetLoggerLevel._md5sum)
EMPTY = b""


def request(logger: str) -> bytes:
    buffer = io.BytesIO()
    SetLoggerLevelRequest(logger, "level").serialize(buffer)
    return buffer.getvalue()


def saying(data: bytes) -> MakeRequest:
    async def make_request(_header: Mapping[str, str]) -> bytes:
        return data

    return make_request


async def fail(_header: Mapping[str, str]) -> bytes:
    return bytes(1 // 0)


async def handle(data: bytes) -> bytes:
    logger = SetLoggerLevelRequest().deserialize(data).logger
    if logger == "bad":
        raise ServiceFailure("no such logger: bäd")
    if logger == "broken":
        raise KeyError(logger)
    await asyncio.sleep(0.01)
    return EMPTY


def test_rospy_calls_our_service_also_again_and_again_over_one_connection(
    run: Run, node: StartNode, peer: RospyPeer
) -> None:
    async def scenario() -> None:
        peer.said.clear()
        async with node("ours") as ours:
            for name, persistent in (("/once", False), ("/kept", True)):
                ours.serve(name, SET_LEVEL, handle)
                peer.do("wait_for_service", name)
                for logger in ("a", "bad", 2**20, "broken"):
                    peer.do("call", name, logger, persistent)
                await eventually(lambda: ["failed", name, "broken"] in [line[:3] for line in peer.said])  # noqa: B023
                assert ["done", name, "a"] in peer.said
                assert ["done", name, 2**20] in peer.said
                failures = {line[2]: line[3] for line in peer.said if line[:2] == ["failed", name]}
                assert "no such logger: b" in failures["bad"]
                assert "internal error" in failures["broken"]
                peer.do("drop", name)

    run(scenario)


def test_we_call_services_of_rospy(run: Run, node: StartNode, peer: RospyPeer) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            peer.do("serve", "/seven", 7)
            peer.do("serve_failing", "/fails")
            peer.do("wait_for_service", "/fails")
            await eventually(lambda: ["there", "/fails"] in peer.said)
            data, header = await ours.call("/seven", saying(EMPTY), 5)
            assert AddNewRobotResponse().deserialize(data).ID == 7
            assert (header["type"], header["md5sum"]) == ("laser_bot_battle/AddNewRobot", AddNewRobot._md5sum)
            assert await ours.probe("/seven") == header
            with pytest.raises(ServiceError, match="no logger mine"):
                await ours.call("/fails", saying(request("mine")), 5, SetLoggerLevel._md5sum)

    peer.said.clear()
    run(scenario)


def test_what_can_go_wrong_with_a_call_is_said(run: Run, node: StartNode) -> None:
    mute = socket.create_server((HOST, 0))

    async def scenario() -> None:
        async with node("ours") as ours, node("other") as other:

            async def slow(_: bytes) -> bytes:
                await asyncio.sleep(60)
                return EMPTY

            other.serve("/slow", SET_LEVEL, slow)
            await registered(other, 2, "/slow")
            await other.master("registerService", "/mute", f"rosrpc://{HOST}:{mute.getsockname()[1]}", other.uri)
            await other.master("registerService", "/gone", f"rosrpc://{HOST}:1", other.uri)
            await other.master("registerService", "/nonsense", "rosrpc://", other.uri)
            await other.master("registerService", "/lost", f"rosrpc://{HOST}:{other.tcpros_address[1]}", other.uri)
            for name, expected in {
                "/none": "there is no such service",
                "/slow": "no response within 0.2 s",
                "/mute": "no response within 0.2 s",
                "/gone": "the connection to the service broke",
                "/nonsense": "impossible address",
                "/lost": "/other does not offer /lost",
            }.items():
                timeout = 0.2 if "0.2 s" in expected else LATEST
                with pytest.raises(ServiceError, match=expected):
                    await ours.call(name, saying(EMPTY), timeout)
            with pytest.raises(ServiceError, match=f"it is {SET_LEVEL.name}"):
                await ours.call("/slow", saying(EMPTY), 5, "0" * 32)
            with pytest.raises(ZeroDivisionError):
                await ours.call("/slow", fail, 5)

    try:
        run(scenario)
    finally:
        mute.close()


def test_a_service_that_ends_cuts_its_callers(run: Run, node: StartNode) -> None:
    async def scenario() -> None:
        async with node("ours") as ours, node("other") as other:
            called = asyncio.Event()

            async def slow(_: bytes) -> bytes:
                called.set()
                await asyncio.sleep(60)
                return EMPTY

            service = other.serve("/ends", SET_LEVEL, slow)
            await registered(other, 2, "/ends")
            call = asyncio.create_task(ours.call("/ends", saying(EMPTY), 30))
            await called.wait()
            service.close()
            with pytest.raises(ServiceError, match="broke"):
                await call
            await registered(other, 2, "/ends", there=False)
            again = other.serve("/ends", SET_LEVEL, handle)
            await registered(other, 2, "/ends")
            assert (await ours.call("/ends", saying(request("a")), 5))[0] == EMPTY
            again.close()

    run(scenario)


def test_a_request_of_an_impossible_length_ends_that_connection_only(run: Run, node: StartNode) -> None:
    async def scenario() -> None:
        async with node("ours") as ours:
            ours.serve("/s", SET_LEVEL, handle)
            raw = await RawPeer.connect(ours)
            await raw.say({"callerid": "/raw", "md5sum": "*", "service": "/s", "persistent": "1"})
            assert (await raw.hear_header())["type"] == SET_LEVEL.name
            await raw.send(b"\xff\xff\xff\xff")
            assert await raw.ended()
            raw.close()
            await registered(ours, 2, "/s")
            assert (await ours.call("/s", saying(request("a")), 5))[0] == EMPTY

    run(scenario)
