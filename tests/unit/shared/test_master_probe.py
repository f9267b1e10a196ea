"""Whatever answers at an announced address, asking costs little time and memory."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from laser_bot_battle.master_probe import is_master
from tests.support.ports import free_port

Answer = Callable[[asyncio.StreamWriter], Awaitable[None]]


def ask(answer: Answer) -> bool:
    """What is_master says of a server that answers so."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.readuntil(b"\r\n\r\n")
        try:
            await answer(writer)
        except ConnectionError:
            pass
        finally:
            writer.close()

    async def run() -> bool:
        async with await asyncio.start_server(serve, "127.0.0.1", 0) as server:
            return await is_master("127.0.0.1", server.sockets[0].getsockname()[1])

    return asyncio.run(run())


def says(text: str) -> Answer:
    async def answer(writer: asyncio.StreamWriter) -> None:
        writer.write(f"HTTP/1.0 200 OK\r\n\r\n{text}".encode())
        await writer.drain()

    return answer


def values(*inner: str) -> str:
    data = "".join(f"<value>{value}</value>" for value in inner)
    array = f"<array><data>{data}</data></array>"
    return (
        f"<?xml version='1.0'?><methodResponse><params><param><value>{array}</value></param></params></methodResponse>"
    )


async def endless(writer: asyncio.StreamWriter) -> None:
    while True:
        writer.write(b"x" * 4096)
        await writer.drain()


async def silent(writer: asyncio.StreamWriter) -> None:
    await asyncio.sleep(3)


def test_a_ros_master_answers() -> None:
    assert ask(says(values("<int>1</int>", "<string></string>", "<int>4711</int>")))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "Hello",
        "<methodResponse>",
        "<html><body>a router</body></html>",
        values("<int>0</int>", "<string></string>", "<int>1</int>"),
        values("<int>1</int>"),
        values(),
        "<methodResponse><fault><value><string>no</string></value></fault></methodResponse>",
        "<methodResponse><params></params></methodResponse>",
        values("<int>one</int>", "", ""),
        values("<nonsense>1</nonsense>", "", ""),
        values("<bigdecimal>x</bigdecimal>", "", ""),
    ],
)
def test_anything_else_is_none(text: str) -> None:
    assert not ask(says(text))


@pytest.mark.timeout(60)
@pytest.mark.parametrize("answer", [endless, silent])
def test_it_is_not_listened_to_for_ever(answer: Answer) -> None:
    assert not ask(answer)


def test_where_nobody_listens_is_none() -> None:
    assert not asyncio.run(is_master("127.0.0.1", free_port()))
