"""JSON to ROS messages and back."""

import importlib
import json
import math
import random
import struct
import sys
import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import cbor2
import genpy
import genpy.generator
import pytest
import std_msgs.msg

import laser_bot_battle.msg
from server.messages.types import ConversionError, MessageType, Types
from server.websocket.requests import dumps

NOW = genpy.Time(1000, 5)
# Every kind of field: alone, in a list, in a list of fixed length, in a message and in lists of messages.
EVERYTHING = """
    bool flag
    uint8[] blob
    char[4] letters
    byte[] signed
    int16[3] three
    uint64 large
    float32 half
    float64[] numbers
    float32[2] two
    bool[] flags
    string text
    string[] texts
    string[2] names
    time when
    time[] times
    duration[1] spans
    Part part
    Part[] parts
    Nothing[] nothings
"""
PART = {"Part": "int8 number\nstring label\nPiece[] pieces\n", "Piece": "float64 x\nuint16[] y\n", "Nothing": ""}
VALUE = {
    "flag": True,
    "blob": "AP8H",
    "letters": "AQIDBA==",
    "signed": [-1, 127],
    "three": [1, -2, 300],
    "large": 2**64 - 1,
    "half": 0.5,
    "numbers": [1e300, -0.25, 1e-7],
    "two": [1.0, -0.0],
    "flags": [True, False],
    "text": 'hä"\\\n\U0001f916',
    "texts": ["", "ß"],
    "names": ["a", "b"],
    "when": {"secs": 2**32 - 1, "nsecs": 999999999},
    "times": [{"secs": 1, "nsecs": 2}, {"secs": 3, "nsecs": 4}],
    "spans": [{"secs": -5, "nsecs": 1}],
    "part": {"number": -128, "label": "x", "pieces": []},
    "parts": [
        {"number": 1, "label": "", "pieces": [{"x": 0.5, "y": [1, 65535]}, {"x": 2.0, "y": []}]},
        {"number": 2, "label": "y", "pieces": []},
    ],
    "nothings": [{}, {}],
}


@pytest.fixture
def types() -> Types:
    return Types()


@pytest.fixture
def packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder on Python's path for packages that tests make; what was imported from it is forgotten in the end."""
    before = set(sys.modules)
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in set(sys.modules) - before:
        if name.startswith("made_"):
            del sys.modules[name]


@pytest.fixture
def everything(packages: Path, types: Types) -> MessageType:
    make_package(packages, "made_all", {"Everything": EVERYTHING, **PART})
    return types.message("made_all/Everything")


def make_package(folder: Path, package: str, messages: dict[str, str]) -> None:
    """A message package as genpy generates it."""
    out = folder / package / "msg"
    sources = folder / f"{package}_sources"
    sources.mkdir(exist_ok=True)
    for name, text in messages.items():
        (sources / f"{name}.msg").write_text("\n".join(line.strip() for line in text.splitlines()))
    files = [str(sources / f"{name}.msg") for name in messages]
    assert genpy.generator.MsgGenerator().generate_messages(package, files, str(out), {package: [str(sources)]}) == 0
    (folder / package / "__init__.py").touch()
    imports = [f"from .{file.stem} import *\n" for file in sorted(out.glob("_[A-Z]*.py"))]
    (out / "__init__.py").write_text("".join(imports))


def clock() -> genpy.Time:
    return NOW


def serialized(message: Any) -> bytes:
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


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
        ("std_msgs/Float32", {"data": 3.4028234663852886e38}),
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
    data = message_type.pack(value, clock)
    assert serialized(message_type.message_class().deserialize(data)) == data
    assert message_type.values(data) == value
    assert message_type.json(data) == dumps(value)


def test_every_kind_of_field_survives_the_way_to_ros_and_back(everything: MessageType) -> None:
    data = everything.pack(VALUE, clock)
    assert serialized(everything.message_class().deserialize(data)) == data
    assert everything.values(data) == VALUE
    assert everything.json(data) == dumps(VALUE)


def test_missing_fields_have_their_default(everything: MessageType, types: Types) -> None:
    assert everything.pack({}, clock) == serialized(everything.message_class())
    assert types.message("laser_bot_battle/Robot_msg").pack({"shoot": True}, clock) == b"\0\0\x01"


@pytest.mark.parametrize("package", [std_msgs.msg, laser_bot_battle.msg])
def test_every_type_has_the_bytes_that_genpy_gives_it(types: Types, package: Any) -> None:
    classes: list[Any] = [
        value for value in vars(package).values() if isinstance(value, type) and issubclass(value, genpy.Message)
    ]
    assert classes
    for message_class in classes:
        message_type = types.message(message_class._type)
        data = message_type.pack({}, genpy.Time)
        assert data == serialized(message_class())
        assert message_type.pack(message_type.values(data), genpy.Time) == data
        assert json.loads(message_type.json(data)) == message_type.values(data)
        assert (message_type.md5sum, message_type.definition) == (message_class._md5sum, message_class._full_text)


def test_a_command_has_the_bytes_that_robots_know(types: Types) -> None:
    command = {"linear_x": -1, "angular_z": -1, "shoot": True}
    assert types.message("laser_bot_battle/Robot_msg").pack(command, clock) == b"\xff\xff\x01"


def test_a_list_of_numbers_is_understood_as_bytes(types: Types) -> None:
    blob = types.message("std_msgs/UInt8MultiArray")
    assert blob.values(blob.pack({"data": [0, 255, 7]}, clock))["data"] == "AP8H"


def test_nanoseconds_beyond_a_second_are_carried_over(types: Types) -> None:
    time = types.message("std_msgs/Time")
    assert time.pack({"data": {"secs": 1, "nsecs": 1500000000}}, clock) == struct.pack("<II", 2, 500000000)


def test_now_is_a_time(types: Types, everything: MessageType) -> None:
    now = {"secs": NOW.secs, "nsecs": NOW.nsecs}
    assert everything.values(everything.pack({"when": "now", "times": ["now"]}, clock))["when"] == now
    with pytest.raises(ConversionError, match="data"):
        types.message("std_msgs/Duration").pack({"data": "now"}, clock)


def test_a_header_is_stamped_unless_it_has_a_stamp(types: Types) -> None:
    header = types.message("std_msgs/Header")
    assert header.values(header.pack({"seq": 1}, clock))["stamp"] == {"secs": NOW.secs, "nsecs": NOW.nsecs}
    assert header.values(header.pack({"stamp": {"secs": 0, "nsecs": 0}}, clock))["stamp"] == {"secs": 0, "nsecs": 0}


def test_what_json_cannot_say_is_null(types: Types, everything: MessageType) -> None:
    sent = everything.message_class(half=-math.inf, numbers=[math.nan, 1.0, math.inf, -math.inf], two=[math.nan, 1.0])
    values = everything.values(serialized(sent))
    assert (values["half"], values["numbers"], values["two"]) == (None, [None, 1.0, None, None], [None, 1.0])
    assert json.loads(everything.json(serialized(sent))) == values
    received = everything.message_class().deserialize(everything.pack({"half": None, "numbers": [None, 2]}, clock))
    assert math.isnan(received.half)
    assert math.isnan(received.numbers[0])
    assert received.numbers[1] == 2.0


def test_text_that_is_not_utf_8_reaches_clients_as_text(types: Types) -> None:
    assert types.message("std_msgs/String").json(b"\x03\0\0\0a\xffb") == '{"data":"a\\ufffdb"}'


def test_cbor_has_bytes_where_json_has_base64_and_lists(everything: MessageType) -> None:
    value = cbor2.loads(cbor2.dumps(everything.cbor(everything.pack(VALUE, clock))))
    assert value["blob"] == b"\x00\xff\x07"
    assert value["letters"] == b"\x01\x02\x03\x04"
    # RFC 8746: 72 int8, 77 int16, 85 float32, 86 float64, 69 uint16, all little endian
    assert value["signed"] == cbor2.CBORTag(72, b"\xff\x7f")
    assert value["three"] == cbor2.CBORTag(77, struct.pack("<3h", 1, -2, 300))
    assert value["two"] == cbor2.CBORTag(85, struct.pack("<2f", 1.0, -0.0))
    assert value["numbers"] == cbor2.CBORTag(86, struct.pack("<3d", 1e300, -0.25, 1e-7))
    assert value["parts"][0]["pieces"][0]["y"] == cbor2.CBORTag(69, b"\x01\x00\xff\xff")
    arrays = {"blob", "letters", "signed", "three", "two", "numbers", "parts"}
    assert {name: part for name, part in value.items() if name not in arrays} == {
        name: part for name, part in VALUE.items() if name not in arrays
    }


def test_bytes_that_do_not_fit_the_type_are_refused(everything: MessageType) -> None:
    data = everything.pack(VALUE, clock)
    for unpack in (everything.values, everything.json, everything.cbor):
        for wrong in (*(data[:end] for end in range(len(data))), data + b"\0"):
            with pytest.raises(ConversionError, match="the bytes are no made_all/Everything"):
                unpack(wrong)


def test_a_huge_number_of_elements_is_refused_before_they_are_made(packages: Path, types: Types) -> None:
    make_package(packages, "made_many", {"Many": "Nothing[] data\n", "Nothing": "", "Texts": "string[] data\n"})
    for name in ("Many", "Texts"):
        with pytest.raises(ConversionError, match="4294967295 elements cannot be"):
            types.message(f"made_many/{name}").json(b"\xff\xff\xff\xff" + bytes(100))


def test_mutated_messages_give_json_or_are_refused(everything: MessageType) -> None:
    dice = random.Random(1)
    data = everything.pack(VALUE, clock)
    understood = 0
    for _ in range(2000):
        mutated = bytearray(data)
        for _ in range(dice.randint(1, 3)):
            mutated[dice.randrange(len(data))] = dice.choice((0, 1, 127, 128, 255))
        try:
            text = everything.json(bytes(mutated))
        except ConversionError:
            continue
        understood += 1
        assert json.loads(text) == everything.values(bytes(mutated))
    assert understood > 100


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
        ("std_msgs/Float32", {"data": 3.402823567797337e38}, "too large for float32"),
        ("std_msgs/Float32", {"data": -1e39}, "too large for float32"),
        ("std_msgs/String", {"data": 5}, "a string is needed"),
        ("std_msgs/String", {"data": "\ud800"}, "half a surrogate pair"),
        ("std_msgs/Time", {"data": 5}, '{"secs": int, "nsecs": int} or "now" is needed'),
        ("std_msgs/Time", {"data": "later"}, 'or "now" is needed'),
        ("std_msgs/Time", {"data": {"secs": -1}}, "data.secs"),
        ("std_msgs/Time", {"data": {"secs": 1.5}}, "data.secs: uint32"),
        ("std_msgs/Time", {"data": {"secs": 1, "usecs": 1}}, "is needed"),
        ("std_msgs/Time", {"data": {"secs": 2**32 - 1, "nsecs": 2**31 - 1}}, "data.secs"),
        ("std_msgs/Time", {"data": {"secs": 0, "nsecs": -1}}, "data"),
        ("std_msgs/Duration", {"data": {"nsecs": 2**31}}, "data.nsecs: int32"),
        ("std_msgs/UInt8MultiArray", {"data": "no base 64!"}, "is not base64, with '!' in it"),
        ("std_msgs/UInt8MultiArray", {"data": "ä"}, "is not base64, with 'ä' in it"),
        ("std_msgs/UInt8MultiArray", {"data": "AA-_"}, "is base64 of the alphabet for URLs"),
        ("std_msgs/UInt8MultiArray", {"data": "AAA"}, "is not base64: incorrect padding"),
        ("std_msgs/UInt8MultiArray", {"data": [0, 256]}, "data[1]: uint8"),
        ("std_msgs/UInt8MultiArray", {"data": None}, "a list is needed"),
        ("std_msgs/Int16MultiArray", {"data": {"0": 1}}, "a list is needed"),
        ("std_msgs/Int16MultiArray", {"data": [1, True]}, "data[1]: int16"),
        ("std_msgs/Int16MultiArray", {"data": [0, 0, None]}, "data[2]: int16"),
        ("std_msgs/Float32MultiArray", {"data": [0, 1e39]}, "data[1]: 1e+39 is too large for float32"),
        ("std_msgs/Float64MultiArray", {"data": [0, "1"]}, "data[1]: a number is needed"),
        ("std_msgs/Int16MultiArray", {"layout": {"dim": [{}, {"size": "x"}]}}, "layout.dim[1].size: uint32"),
        ("std_msgs/Int16MultiArray", {"layout": {"dim": [None]}}, "layout.dim[0]: an object of type"),
        ("std_msgs/Int16MultiArray", {"layout": {"dim": {}}}, "layout.dim: a list is needed"),
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
        types.message(type_name).pack(value, clock)
    assert reason in str(refused.value)


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ({"letters": "AQID"}, "letters: 4 bytes are needed, not 3"),
        ({"letters": [1, 2, 3]}, "letters: 4 elements are needed, not 3"),
        ({"three": [1, 2, 3, 4]}, "three: 3 elements are needed, not 4"),
        ({"names": ["a"]}, "names: 2 elements are needed, not 1"),
        ({"texts": ["a", 5]}, "texts[1]: a string is needed"),
        ({"flags": [True, 0]}, "flags[1]: true or false is needed"),
        ({"three": "AAAA"}, "three: a list is needed"),
        ({"parts": [{}, {"pieces": [{"y": [1, -1]}]}]}, "parts[1].pieces[0].y[1]: uint16"),
        ({"part": {"size": 1}}, "part: made_all/Part has no field 'size'"),
    ],
)
def test_a_wrong_element_is_refused_with_its_place(everything: MessageType, value: Any, reason: str) -> None:
    with pytest.raises(ConversionError) as refused:
        everything.pack(value, clock)
    assert reason in str(refused.value)


@pytest.mark.parametrize(
    "name", ["", "String", "std_msgs/", "/std_msgs/String", "std_msgs/Nothing", "nothing/String", "os.path/x", "a/b/c"]
)
def test_an_unknown_type_is_refused(types: Types, name: str) -> None:
    with pytest.raises(ConversionError, match=r"unknown here|is not a message type"):
        types.message(name)
    with pytest.raises(ConversionError, match=r"unknown here|is not a service type"):
        types.service(name)


def test_a_type_that_appears_later_is_found_at_most_a_second_later(packages: Path) -> None:
    now = 100.0
    types = Types(lambda: now)
    make_package(packages, "made_late", {"First": "int8 x\n"})
    types.message("made_late/First")
    for name in ("made_late/Second", "made_later/Third"):
        with pytest.raises(ConversionError, match="unknown here"):
            types.message(name)
    make_package(packages, "made_late", {"Second": "int8 y\n"})
    make_package(packages, "made_later", {"Third": "int8 z\n"})
    now += 0.9
    with pytest.raises(ConversionError, match="unknown here"):
        types.message("made_late/Second")
    now += 0.1
    assert types.message("made_late/Second").fields == ("y",)
    assert types.message("made_later/Third").fields == ("z",)


def test_only_message_packages_are_imported(packages: Path, types: Types) -> None:
    (packages / "made_trap").mkdir()
    (packages / "made_trap/__init__.py").write_text("raise SystemExit('imported')")
    with pytest.raises(ConversionError, match="unknown here"):
        types.message("made_trap/Type")
    assert "made_trap" not in sys.modules


def test_a_broken_package_is_refused_with_the_reason(packages: Path, types: Types) -> None:
    (packages / "made_broken/msg").mkdir(parents=True)
    (packages / "made_broken/msg/_Type.py").write_text("import made_nowhere.msg\n")
    with pytest.raises(ConversionError, match="made_broken/Type cannot be loaded: No module named 'made_nowhere'"):
        types.message("made_broken/Type")


def test_a_service_type_has_a_request_and_a_response(types: Types) -> None:
    service = types.service("laser_bot_battle/AddNewRobot")
    assert service.md5sum == "0cb5143ed23a5de01874507c8711c4d5"
    assert service.response.json(b"\x03") == '{"ID":3}'
    with pytest.raises(ConversionError, match="has no field"):
        service.pack_request({"ID": 3}, clock)


def test_a_service_takes_an_object_or_the_first_arguments_in_their_order(packages: Path, types: Types) -> None:
    folder = packages / "made_call"
    folder.mkdir()
    (folder / "Call.srv").write_text("int8 a\nstring b\nint8 c\n---\n")
    generator = genpy.generator.SrvGenerator()
    assert generator.generate_messages("made_call", [str(folder / "Call.srv")], str(folder / "srv"), {}) == 0
    service = types.service("made_call/Call")
    understood: list[Any] = [{"a": 1, "b": "x"}, [1, "x"], [1, "x", 0]]
    for args in understood:
        assert service.pack_request(args, clock) == b"\x01\x01\0\0\0x\0"
    assert service.pack_request(None, clock) == service.pack_request([], clock) == bytes(6)
    refused: dict[str, Any] = {r"takes 3 arguments \(a, b, c\), not 4": [1, "x", 0, 0], "a: int8": ["x"], "object": "x"}
    for reason, args in refused.items():
        with pytest.raises(ConversionError, match=reason):
            service.pack_request(args, clock)


@pytest.mark.parametrize("first", ["", "class Thing: pass\n", "class Thing(:\n", "import no_such_module\n"])
def test_a_type_whose_file_was_half_written_is_looked_for_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, first: str
) -> None:
    package = f"half_written_{zlib.crc32(first.encode())}"
    folder = tmp_path / package / "msg"
    folder.mkdir(parents=True)
    for init in (folder / "__init__.py", folder.parent / "__init__.py"):
        init.touch()
    written = folder / "_Thing.py"
    written.write_text(first)
    monkeypatch.syspath_prepend(tmp_path)
    now = 0.0
    types = Types(lambda: now)
    with pytest.raises(ConversionError):
        types.message(f"{package}/Thing")
    whole = Path(str(importlib.import_module("std_msgs.msg._Int8").__file__)).read_text()
    written.write_text(whole.replace("Int8", "Thing"))
    now = 2.0
    assert types.message(f"{package}/Thing").pack({"data": 3}, clock) == b"\x03"
