"""Our node between a real ROS master and rospy, on asyncio's event loop and on uvloop."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from typing import Any

import pytest
import uvloop

from tcpros.node import Node
from tests.integration.tcpros.ends import RospyPeer
from tests.support.ros import HOST, RosMaster, own_master, ros_master

__all__ = ["own_master", "ros_master"]

Scenario = Callable[[], Coroutine[Any, Any, None]]
StartNode = Callable[..., contextlib.AbstractAsyncContextManager[Node]]


@pytest.fixture(autouse=True)
def addresses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_IP", HOST)
    monkeypatch.setenv("ROS_HOSTNAME", HOST)


@pytest.fixture(params=[asyncio.new_event_loop, uvloop.new_event_loop], ids=["asyncio", "uvloop"])
def run(request: pytest.FixtureRequest) -> Callable[[Scenario], None]:
    """Runs a coroutine on each of the two event loops; it must leave no task."""

    def run(scenario: Scenario) -> None:
        async def complete() -> None:
            await scenario()
            await asyncio.sleep(0)
            assert len(asyncio.all_tasks()) == 1

        with asyncio.Runner(loop_factory=request.param) as runner:
            runner.run(complete())

    return run


@pytest.fixture
def node(ros_master: RosMaster) -> StartNode:
    """`async with node("name")`: a node that is started, and closed at the end."""

    @contextlib.asynccontextmanager
    async def started(name: str, uri: str = ros_master.uri) -> AsyncIterator[Node]:
        node = Node(name, uri)
        await node.start()
        try:
            yield node
        finally:
            await node.close()

    return started


@pytest.fixture(scope="module")
def peer(ros_master: RosMaster) -> Iterator[RospyPeer]:
    """One rospy node for a module: its tests use topics of their own."""
    peer = RospyPeer("peer", ros_master.env)
    yield peer
    peer.close()
