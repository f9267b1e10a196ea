"""JSON to ROS messages and back."""

import math
from io import BytesIO
from typing import Any

import genpy
import pytest

from laser_bot_battle.msg import GameStatus, Robot_msg, UserStatus
from server.rosbridge.conversion import ConversionError, Types


@pytest.fixture
def types() -> Types:
    return Types()


@pytest.mark.parametrize(
    ("type_name", "value"),
    [
        ("laser_bot_battle/Robot_msg", {"linear_x": 1, "angular_z": -1, "shoot": False}),
        ("std_msgs/Empty", {}),
        ("std_msgs/Bool", {"data": True}),
        ("std_msgs/Int8", {"data": -128}),
        ("std_msgs/Byte", {"data": 127}),
        ("std_msgs/Char", {"data": 255}),
        ("std_msgs/UInt64", {"data": 2**64 - 1}),
        ("std_msgs/Int64", {"data": -(2**63)}),
        ("std_msgs/Float32", {"data": 0.5}),
        ("std_msgs/Float64", {"data": 1e300}),
        ("std_msgs/String", {"data": "häßlich \U0001f916"}),
        ("std_msgs/Time", {"data": {"secs": 2**32 - 1, "nsecs": 999999999}}),
        ("std_msgs/Duration", {"data": {"secs": -5, "nsecs": 1}}),
        ("std_msgs/ColorRGBA", {"r": 0.0, "g": 0.25, "b": 0.5, "a": 1.0}),
        ("std_msgs/Header", {"seq": 1, "stamp": {"secs": 2, "nsecs": 3}, "frame_id": "x"}),
        (
            "std_msgs/UInt8MultiArray",
            {"layout": {"dim": [{"label": "x", "size": 3, "stride": 3}], "data_offset": 0}, "data": "AP8H"},
        ),
        ("std_msgs/Int16MultiArray", {"layout": {"dim": [], "data_offset": 0}, "data": [-5, 300]}),
        ("std_msgs/Float32MultiArray", {"layout": {"dim": [], "data_offset": 0}, "data": [0.5, -1.0]}),
    ],
)
def test_a_message_survives_the_way_to_ros_and_back(types: Types, type_name: str, value: dict[str, Any]) -> None:
    message_type = types.message(type_name)
    message = message_type.decode(value, "")
    buffer = BytesIO()
    message.serialize(buffer)
    received = message_type.message_class().deserialize(buffer.getvalue())
    assert message_type.encode(received) == value


def test_a_command_has_the_bytes_that_robots_know(types: Types) -> None:
    buffer = BytesIO()
    command = {"linear_x": -1, "angular_z": -1, "shoot": True}
    types.message("laser_bot_battle/Robot_msg").decode(command, "").serialize(buffer)
    assert buffer.getvalue() == b"\xff\xff\x01"


def test_missing_fields_keep_their_default(types: Types) -> None:
    assert types.message("laser_bot_battle/Robot_msg").decode({"shoot": True}, "") == Robot_msg(0, 0, True)


def test_a_list_of_numbers_is_understood_as_bytes(types: Types) -> None:
    assert types.message("std_msgs/UInt8MultiArray").decode({"data": [0, 255, 7]}, "").data == b"\x00\xff\x07"


def test_nanoseconds_beyond_a_second_are_carried_over(types: Types) -> None:
    time = types.message("std_msgs/Time").decode({"data": {"secs": 1, "nsecs": 1500000000}}, "").data
    assert time == genpy.Time(2, 500000000)


def test_what_json_cannot_say_is_sent_as_null(types: Types) -> None:
    status = GameStatus(time_left=math.nan, users=[UserStatus(name="al")])
    value = types.message("laser_bot_battle/GameStatus").encode(status)
    assert value["time_left"] is None
    assert value["users"][0]["name"] == "al"
    infinite = types.message("std_msgs/Float64MultiArray")
    assert infinite.encode(infinite.message_class(data=[math.inf, 1.0]))["data"] == [None, 1.0]


@pytest.mark.parametrize(
    ("type_name", "value", "reason"),
    [
        ("std_msgs/Int8", {"data": 128}, "data: int8 is a whole number from -128 to 127, not 128"),
        ("std_msgs/Int8", {"data": -129}, "int8"),
        ("std_msgs/UInt8", {"data": -1}, "uint8"),
        ("std_msgs/UInt64", {"data": 2**64}, "uint64"),
        ("std_msgs/Int32", {"data": 1.0}, "int32"),
        ("std_msgs/Int32", {"data": True}, "int32"),
        ("std_msgs/Int32", {"data": "1"}, "int32"),
        ("std_msgs/Int32", {"data": None}, "int32"),
        ("std_msgs/Bool", {"data": 1}, "true or false is needed, not 1"),
        ("std_msgs/Float64", {"data": "1"}, "a number is needed"),
        ("std_msgs/Float64", {"data": False}, "a number is needed"),
        ("std_msgs/Float64", {"data": 10**400}, "too large for float64"),
        ("std_msgs/Float32", {"data": 1e39}, "too large for float32"),
        ("std_msgs/String", {"data": 5}, "a string is needed"),
        ("std_msgs/String", {"data": "\ud800"}, "half a surrogate pair"),
        ("std_msgs/Time", {"data": 5}, '{"secs": int, "nsecs": int} is needed'),
        ("std_msgs/Time", {"data": {"secs": -1}}, "data.secs"),
        ("std_msgs/Time", {"data": {"secs": 1, "usecs": 1}}, "is needed"),
        ("std_msgs/Time", {"data": {"secs": 2**32 - 1, "nsecs": 2**31 - 1}}, "data.secs"),
        ("std_msgs/Time", {"data": {"secs": 0, "nsecs": -1}}, "data"),
        ("std_msgs/UInt8MultiArray", {"data": "no base 64"}, "is not base64"),
        ("std_msgs/UInt8MultiArray", {"data": "ä"}, "is not base64"),
        ("std_msgs/UInt8MultiArray", {"data": [0, 256]}, "data[1]"),
        ("std_msgs/Int16MultiArray", {"data": {"0": 1}}, "a list is needed"),
        ("std_msgs/Int16MultiArray", {"layout": {"dim": [{"size": "x"}]}}, "layout.dim[0].size"),
        ("std_msgs/Header", {"seq": 1, "sequence": 1}, "std_msgs/Header has no field 'sequence'"),
        ("std_msgs/Header", [1, 2, 3], "an object of type std_msgs/Header is needed"),
        ("std_msgs/Empty", {"x": 1}, "has no field 'x'"),
        ("laser_bot_battle/Robot_msg", {"__class__": 1}, "has no field"),
        ("laser_bot_battle/Robot_msg", {"_connection_header": {}}, "has no field"),
    ],
)
def test_a_value_that_does_not_fit_is_refused_with_its_place(
    types: Types, type_name: str, value: Any, reason: str
) -> None:
    with pytest.raises(ConversionError) as refused:
        types.message(type_name).decode(value, "")
    assert reason in str(refused.value)


@pytest.mark.parametrize(
    "name", ["", "String", "std_msgs/", "/std_msgs/String", "std_msgs/Nothing", "nothing/String", "os.path/x", "a/b/c"]
)
def test_an_unknown_type_is_refused(types: Types, name: str) -> None:
    with pytest.raises(ConversionError, match=r"unknown here|is not a message type"):
        types.message(name)
    with pytest.raises(ConversionError, match=r"unknown here|is not a service type"):
        types.service(name)


def test_a_service_type_has_a_request_and_a_response(types: Types) -> None:
    service = types.service("laser_bot_battle/AddNewRobot")
    assert service.md5sum == "0cb5143ed23a5de01874507c8711c4d5"
    assert service.response.encode(service.response.message_class(ID=3)) == {"ID": 3}
    with pytest.raises(ConversionError, match="has no field"):
        service.request.decode({"ID": 3}, "")
