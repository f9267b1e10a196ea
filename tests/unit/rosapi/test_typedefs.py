"""What rosapi tells about types."""

import pytest

from server.messages.types import ConversionError, Types
from server.rosapi.typedefs import class_typedefs, message_typedefs

TIME = {
    "type": "time",
    "fieldnames": ["secs", "nsecs"],
    "fieldtypes": ["int32", "int32"],
    "fieldarraylen": [-1, -1],
    "examples": ["0", "0"],
    "constnames": [],
    "constvalues": [],
}
HEADER = {
    "type": "std_msgs/Header",
    "fieldnames": ["seq", "stamp", "frame_id"],
    "fieldtypes": ["uint32", "time", "string"],
    "fieldarraylen": [-1, -1, -1],
    "examples": ["0", "{}", ""],
    "constnames": [],
    "constvalues": [],
}


def test_a_message_comes_with_its_constants_and_with_the_messages_in_it() -> None:
    log = {
        "type": "rosgraph_msgs/Log",
        "fieldnames": ["header", "level", "name", "msg", "file", "function", "line", "topics"],
        "fieldtypes": ["std_msgs/Header", "byte", "string", "string", "string", "string", "uint32", "string"],
        "fieldarraylen": [-1, -1, -1, -1, -1, -1, -1, 0],
        "examples": ["{}", "0", "", "", "", "", "0", "[]"],
        "constnames": ["DEBUG", "ERROR", "FATAL", "INFO", "WARN"],
        "constvalues": ["1", "8", "16", "2", "4"],
    }
    assert message_typedefs(Types(), "rosgraph_msgs/Log") == [log, HEADER, TIME]


def test_a_type_that_is_there_several_times_is_told_once() -> None:
    told = [typedef["type"] for typedef in message_typedefs(Types(), "rosgraph_msgs/TopicStatistics")]
    assert told == ["rosgraph_msgs/TopicStatistics", "time", "duration"]


@pytest.mark.parametrize(
    ("name", "lengths", "examples"),
    [
        ("std_msgs/Char", [-1], ["0"]),
        ("std_msgs/Bool", [-1], ["False"]),
        ("std_msgs/Float64", [-1], ["0.0"]),
        ("std_msgs/UInt8MultiArray", [-1, 0], ["{}", "[]"]),
        ("std_msgs/Empty", [], []),
    ],
)
def test_examples_are_the_defaults(name: str, lengths: list[int], examples: list[str]) -> None:
    typedef = message_typedefs(Types(), name)[0]
    assert (typedef["fieldarraylen"], typedef["examples"]) == (lengths, examples)


def test_services_are_told_by_request_and_response() -> None:
    types = Types()
    service = types.service("rosapi/ServiceRequestDetails")
    (request,) = class_typedefs(types, service.request.message_class)
    response = class_typedefs(types, service.response.message_class)
    assert (request["type"], request["fieldnames"]) == ("rosapi/ServiceRequestDetailsRequest", ["type"])
    assert [typedef["type"] for typedef in response] == ["rosapi/ServiceRequestDetailsResponse", "rosapi/TypeDef"]


def test_built_in_types_are_known() -> None:
    types = Types()
    assert message_typedefs(types, "string") == []
    assert message_typedefs(types, "time") == [TIME]
    with pytest.raises(ConversionError, match="unknown"):
        message_typedefs(types, "std_msgs/Strong")
