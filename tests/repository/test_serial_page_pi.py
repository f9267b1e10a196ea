"""docs/protocol-serial.md against the Pi's side of the serial line."""

import pytest

from laser_bot_battle.msg import BoardHealth, Hit, Robot_msg, Setup
from laser_bot_battle.names import ROSSERIAL_PORT
from robot.board_server import MAX_BOARDS, MAX_OF_ONE_MACHINE, SUCCESSION
from robot.rosserial import ids
from robot.rosserial.announcements import KINDS, MAX_TOPICS
from robot.rosserial.events import DevicePublishes, DeviceSubscribes, Event, Message, Send
from robot.rosserial.frame import Decoder, Frame, encode
from robot.rosserial.host import Host
from robot.serial.connection import MAX_RATE, MAX_UNDER_WAY
from robot.serial.device_topics import serialised
from robot.serial.port import BAUDRATE
from robot.serial.transmit_queue import MAX_ANSWERS
from tests.support.documents import Row, page, table, value_of

PAGE = page("protocol-serial.md")
CONVERSATION = table(PAGE, "Conversation")
COMMANDS = table(PAGE, "Commands")
MESSAGES = table(PAGE, "Messages")
WALL = 1_700_000_000.25  # s since 1970, as on the page


def data(row: Row) -> bytes:
    return bytes.fromhex(row["bytes"])


def the_frame(row: Row) -> Frame:
    (frame,) = Decoder().feed(data(row), 0.0)
    return frame


def test_the_speed_is_told() -> None:
    assert f"at {BAUDRATE} baud" in PAGE


@pytest.mark.parametrize("row", CONVERSATION + MESSAGES + COMMANDS, ids=lambda row: row["what"])
def test_the_bytes_are_one_frame(row: Row) -> None:
    frame = the_frame(row)
    assert encode(frame.topic_id, frame.payload) == data(row)


@pytest.mark.parametrize("row", COMMANDS, ids=lambda row: row["what"])
def test_the_bytes_of_a_command_are_its_message(row: Row) -> None:
    message = Robot_msg(int(row["linear_x"]), int(row["angular_z"]), row["shoot"] == "true")
    assert the_frame(row) == Frame(100, serialised(message))


def test_the_conversation_is_held_by_the_pi() -> None:
    """What the Pi says is what the page says, at the page's places; what the Arduino says is understood."""
    pi = Host(0.0)
    said = [event.data for event in pi.tick(0.0, WALL) if isinstance(event, Send)]
    heard: list[Event] = []
    for row in CONVERSATION:
        if row["from"] == "Arduino":
            events = pi.receive(data(row), 0.0, WALL)
            said += [event.data for event in events if isinstance(event, Send)]
            heard += [event for event in events if not isinstance(event, Send)]
    assert [*said, ids.STOP_SENDING] == [data(row) for row in CONVERSATION if row["from"] == "Pi"]
    *topics, hit = heard
    assert [(type(told), told.info.topic_id) for told in topics] == [  # type: ignore[union-attr]
        (DevicePublishes, 125),
        (DeviceSubscribes, 100),
        (DevicePublishes, 126),
        (DevicePublishes, 127),
        (DeviceSubscribes, 101),
        (DeviceSubscribes, 102),
    ]
    assert hit == Message(125, b"")


def test_the_bytes_of_the_messages_are_what_they_say() -> None:
    coded, plain, identify, hit, health = (the_frame(row) for row in MESSAGES)
    assert coded == Frame(101, serialised(Setup(ID=5, team=2, mode=Setup.CODED, cooldown=500, damage=3)))
    assert plain == Frame(101, serialised(Setup(ID=5, team=2, mode=Setup.PLAIN, cooldown=500, damage=3)))
    assert identify == Frame(102, b"")
    assert hit == Frame(126, serialised(Hit(shooter=42, team=1, damage=9)))
    message = BoardHealth()
    message.deserialize(health.payload)
    assert (health.topic_id, message.major, message.uptime, message.supply, message.shots) == (127, 2, 61, 5006, 7)


def test_the_topic_ids_are_the_protocols() -> None:
    told = {int(word) for row in table(PAGE, "Topic ids") for word in row["id"].split(",")}
    reserved = {*KINDS, ids.PARAMETER, ids.LOG, ids.TIME, ids.TX_STOP}
    used = {the_frame(row).topic_id for row in CONVERSATION + MESSAGES + COMMANDS}
    assert told >= reserved | {100, 101, 102, 125, 126, 127}
    assert not [topic_id for topic_id in told - reserved if topic_id < ids.FIRST_TOPIC]
    assert used <= told


def test_the_limit_of_topics_is_told() -> None:
    assert f"more than {MAX_TOPICS} topics" in PAGE


def test_the_room_of_the_line_is_told() -> None:
    assert f"of the other frames {MAX_ANSWERS} bytes" in PAGE


def test_the_limits_by_tcp_are_told() -> None:
    assert f"more than\n  {MAX_UNDER_WAY} bytes are under way" in PAGE
    assert f"at most {MAX_RATE:,} bytes/s are read" in PAGE
    assert f"waits up to {SUCCESSION:g} s" in PAGE
    assert f"connect to port {ROSSERIAL_PORT}" in PAGE
    build = page("build-a-robot.md")
    assert f"{MAX_BOARDS} boards at once, {MAX_OF_ONE_MACHINE} of them at one address" in build
    assert f"tcp-listen://:{ROSSERIAL_PORT}" in build


@pytest.mark.parametrize("row", table(PAGE, "Times"), ids=lambda row: row["where"])
def test_times_are_those_of_the_code(row: Row) -> None:
    assert float(row["value"].split()[0]) == value_of(row["where"])
