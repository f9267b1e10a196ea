"""Messages that take long to encode: a process of its own does it, and nobody else waits for it."""

import bisect
import itertools
import json
import os
import signal
from collections.abc import Callable, Iterator

import psutil
import pytest

from server.rosbridge.compression import to_png
from server.rosbridge.fragments import split
from tests.integration.rosbridge.conftest import Rosbridge
from tests.integration.rosbridge.ends import Client, RosSide, join
from tests.support.polling import until
from tests.support.ros import RosMaster

CELLS = 300 * 300
MAP = "nav_msgs/OccupancyGrid"
TEXT = "std_msgs/String"
Connect = Callable[..., Client]
NUMBERS = itertools.count()


def cells(number: int, count: int = CELLS) -> dict[str, list[int]]:
    """A map that begins with that number."""
    return {"data": [number, -1, -128, *[cell % 128 for cell in range(count - 3)]]}


def first_cells(page: Client, count: int) -> list[int]:
    """Of the next maps; an assertion about whole ones would print them."""
    return [page.hear(20)["msg"]["data"][0] for _ in range(count)]


def is_there(client: Client, service: str) -> bool:
    client.say("call_service", service="/rosapi/services")
    return service in client.hear()["values"]["services"]


def encoder_of(rosbridge: Rosbridge) -> psutil.Process | None:
    """The process that encodes."""
    children = psutil.Process(rosbridge.program.process.pid).children()
    found = [child for child in children if "server.messages.outside" in " ".join(child.cmdline())]
    return found[0] if found else None


@pytest.fixture
def topic() -> str:
    """No other test's: a latched map outlives its client for a while."""
    return f"/map{next(NUMBERS)}"


@pytest.fixture
def maps(client: Connect, topic: str) -> Client:
    """Draws maps."""
    maps = client().operate()
    maps.say("advertise", topic=topic, type=MAP, latch=True)
    return maps


@pytest.fixture
def page(client: Connect, maps: Client, topic: str) -> Client:
    """Looks at maps, and has one already."""
    page = client().operate()
    maps.say("publish", topic=topic, msg=cells(0))
    page.say("subscribe", topic=topic, type=MAP)
    assert first_cells(page, 1) == [0]
    return page


@pytest.fixture
def frozen(rosbridge: Rosbridge, page: Client) -> Iterator[psutil.Process]:
    """The process, which stands still."""
    process = encoder_of(rosbridge)
    assert process is not None
    process.send_signal(signal.SIGSTOP)
    yield process
    process.send_signal(signal.SIGCONT)


def test_maps_come_whole_and_in_order(topic: str, maps: Client, page: Client) -> None:
    sent = [cells(1), cells(2, 5), cells(3), cells(4, 5)]
    for message in sent:
        maps.say("publish", topic=topic, msg=message)
    heard = [page.hear(20)["msg"]["data"] == message["data"] for message in sent]
    assert all(heard), heard


def test_who_comes_later_gets_the_latched_map(client: Connect, topic: str, page: Client) -> None:
    later = client().operate()
    later.say("subscribe", topic=topic, type=MAP)
    assert first_cells(later, 1) == [0]


def test_nobody_waits_for_a_map_but_the_topic(
    topic: str, client: Connect, ros: RosSide, page: Client, frozen: psutil.Process
) -> None:
    join(lambda data: ros.publish(topic, MAP, data=data), page, lambda number: [number])
    for message in (cells(1), cells(2, 5)):
        ros.publish(topic, MAP, **message)
    page.say("subscribe", topic="/say", type=TEXT)
    other = client().operate()
    other.say("advertise", topic="/say", type=TEXT, latch=True)
    for number in range(20):
        other.say("publish", topic="/say", msg={"data": str(number)})
    heard: list[str] = []
    while len(heard) < 20:
        said = page.hear()
        assert said["topic"] == "/say"
        heard.append(said["msg"]["data"])
    assert heard == list(map(str, range(20)))
    frozen.send_signal(signal.SIGCONT)
    assert first_cells(page, 2) == [1, 2]


def test_when_the_process_dies_the_next_map_comes(rosbridge: Rosbridge, topic: str, maps: Client, page: Client) -> None:
    process = encoder_of(rosbridge)
    assert process is not None
    process.kill()

    def comes() -> bool:
        maps.say("publish", topic=topic, msg=cells(7))
        return not page.hears_nothing_for_now(2)

    until(comes, 20)
    assert encoder_of(rosbridge) != process


def test_it_never_has_the_priority_of_commands(rosbridge: Rosbridge, page: Client) -> None:
    process = encoder_of(rosbridge)
    assert process is not None
    assert os.sched_getscheduler(process.pid) == os.SCHED_OTHER
    assert process.nice() == 10


@pytest.mark.parametrize("compression", ["none", "png", "cbor"])
def test_long_answers_of_services_come_whole(client: Connect, compression: str) -> None:
    server, caller = client().operate(), client().operate()
    server.say("advertise_service", service="/long", type="std_srvs/Trigger")
    until(lambda: is_there(caller, "/long"), 10)
    caller.say("call_service", service="/long", id="1", compression=compression)
    request = server.hear()
    values = {"success": True, "message": "long " * 300_000}
    server.say("service_response", service="/long", id=request["id"], values=values, result=True)
    answer = caller.hear_cbor(20) if compression == "cbor" else caller.hear(20)
    if compression == "png":
        assert answer["op"] == "png"
        return
    assert (answer["id"], answer["values"], answer["result"]) == ("1", values, True)


@pytest.fixture
def keeper(client: Connect) -> Client:
    """Offers a service that takes a map."""
    keeper, other = client().operate(), client().operate()
    keeper.say("advertise_service", service="/keep", type="nav_msgs/SetMap")
    until(lambda: is_there(other, "/keep"), 10)
    return keeper


def test_a_service_gets_a_long_request_whole(client: Connect, keeper: Client) -> None:
    caller = client().operate()
    caller.say("call_service", service="/keep", id="1", args={"map": cells(5)})
    asked = keeper.hear(20)
    assert list(asked) == ["op", "id", "service", "args"]
    assert asked["args"]["map"]["data"] == cells(5)["data"]
    keeper.say("service_response", service="/keep", id=asked["id"], values={"success": True}, result=True)
    assert caller.hear(20)["values"] == {"success": True}


def test_nobody_waits_for_a_long_request_to_a_service(
    client: Connect, keeper: Client, page: Client, frozen: psutil.Process
) -> None:
    caller, other = client().operate(), client().operate()
    caller.say("call_service", service="/keep", args=[cells(5)])
    other.say("call_service", service="/rosapi/get_time", id="now")
    assert other.hear()["id"] == "now"
    assert keeper.hears_nothing_for_now()
    frozen.send_signal(signal.SIGCONT)
    assert keeper.hear(20)["args"]["map"]["data"] == cells(5)["data"]


@pytest.mark.parametrize("service", ["/long_answer", "/rosapi/topics_and_raw_types"])
def test_nobody_waits_for_a_long_answer_of_a_service(client: Connect, frozen: psutil.Process, service: str) -> None:
    caller, other = client().operate(), client().operate()
    until(lambda: is_there(other, service))
    caller.say("call_service", service=service, id="1")
    assert caller.hears_nothing_for_now()
    other.say("call_service", service="/rosapi/get_time", id="now")
    assert other.hear()["id"] == "now"
    frozen.send_signal(signal.SIGCONT)
    answer = caller.hear(20)
    assert (answer["id"], answer["result"]) == ("1", True)


def test_what_is_wrong_with_a_long_request_to_a_service_is_told(client: Connect, keeper: Client) -> None:
    caller = client().operate()
    caller.say("call_service", service="/keep", id="1", args={"map": {"data": "y" * 10**5}})
    answer = caller.hear(20)
    while answer["op"] == "status":
        answer = caller.hear(20)
    assert answer["result"] is False
    assert "data" in answer["values"]
    assert keeper.hears_nothing_for_now()


def test_what_is_wrong_with_a_long_response_is_told_to_both(client: Connect, keeper: Client) -> None:
    caller = client().operate()
    caller.say("call_service", service="/keep", id="1")
    asked = keeper.hear()
    wrong = {"success": "y" * 10**5}
    keeper.say("service_response", service="/keep", id=asked["id"], values=wrong, result=True)
    assert "success" in keeper.hear_error()
    answer = caller.hear(20)
    while answer["op"] == "status":
        answer = caller.hear(20)
    assert answer["result"] is False


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT])
def test_it_ends_with_rosbridge(own_master: RosMaster, topic: str, end: signal.Signals) -> None:
    own_master.start()
    own = Rosbridge(own_master)
    own.program.wait_for("listening")
    with Client(own.port).operate() as page:
        page.say("subscribe", topic=topic, type=MAP)
        page.say("advertise", topic=topic, type=MAP, latch=True)
        page.say("publish", topic=topic, msg=cells(0))
        assert first_cells(page, 1) == [0]
        process = encoder_of(own)
        assert process is not None
        own.program.process.send_signal(end)
        own.program.exit_code()
        process.wait(5)


@pytest.mark.parametrize("wrapper", ["", "fragment", "png"])
def test_large_requests_come_whole_and_in_order(topic: str, maps: Client, page: Client, wrapper: str) -> None:
    for number in (1, 2):
        say_in(wrapper, maps, op="publish", topic=topic, msg=cells(number))
        maps.say("publish", topic=topic, msg=cells(10 + number, 5))
    assert first_cells(page, 4) == [1, 11, 2, 12]


def test_nobody_waits_for_a_large_request_but_its_client(
    topic: str, client: Connect, maps: Client, page: Client, frozen: psutil.Process
) -> None:
    maps.say("publish", topic=topic, msg=cells(1))
    maps.say("call_service", service="/rosapi/get_time", id="later")
    other = client().operate()
    other.say("call_service", service="/rosapi/get_time", id="now")
    assert other.hear()["id"] == "now"
    assert maps.hears_nothing_for_now()
    frozen.send_signal(signal.SIGCONT)
    assert maps.hear(20)["id"] == "later"
    assert first_cells(page, 1) == [1]


@pytest.mark.parametrize(
    ("request_", "error"),
    [
        ({"op": "publish", "topic": "/x", "type": "std_msgs/Int8", "msg": {"data": "y" * 10**5}}, "data: int8 is"),
        ({"op": "publish", "topic": "/x", "type": "no/Such", "msg": {"data": "y" * 10**5}}, "no/Such"),
        ({"op": "publish", "topic": 5, "msg": {"data": "y" * 10**5}}, "'topic'"),
        ({"op": "y" * 10**5}, "is unknown here"),
        ({"op": "png", "data": "y" * 10**5}, "no text in a PNG image"),
    ],
)
def test_what_is_wrong_with_a_large_request_is_told(client: Connect, request_: dict[str, object], error: str) -> None:
    wrong = client().operate()
    wrong.socket.send(json.dumps(request_))
    assert error in wrong.hear_error()
    wrong.say("call_service", service="/rosapi/get_time", id="goes on")
    assert wrong.hear()["id"] == "goes on"


def test_what_is_nested_too_deeply_to_be_handed_back_is_told(rosbridge: Rosbridge, client: Connect) -> None:
    wrong = client().operate()
    levels = 9 * deepest() // 10  # read, but not handed from process to process, which takes two calls a level
    deep = '{"op":"x","a":' + '{"a":' * levels + "1" + "}" * (levels + 1)
    wrong.socket.send(deep + deep)  # exactly one would be read at once
    assert "nested too deeply" in wrong.hear_error()
    wrong.say("call_service", service="/rosapi/get_time", id="goes on")
    assert wrong.hear()["id"] == "goes on"
    assert "Traceback" not in rosbridge.program.output


def deepest() -> int:
    """How many objects in each other this Python reads: 1000 calls deep, or as deep as its C code may go."""

    def is_read(levels: int) -> bool:
        try:
            json.loads('{"a":' * levels + "1" + "}" * levels)
        except RecursionError:
            return False
        return True

    return bisect.bisect_left(range(1_000_000), True, key=lambda levels: not is_read(levels)) - 1


def say_in(wrapper: str, client: Client, **request: object) -> None:
    text = json.dumps(request)
    if wrapper == "png":
        client.say("png", data=to_png(text))
    elif wrapper == "fragment":
        for fragment in split(text, 50_000, "1"):
            client.socket.send(fragment)
    else:
        client.socket.send(text)
