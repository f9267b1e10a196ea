import pytest

from robot.rosserial.topic_info import TopicInfo

COMMAND = TopicInfo(100, "command", "laser_bot_battle/Robot_msg", "aa81278360e1bdd1ffce0a4efe0ae199", 280)
COMMAND_BYTES = (
    b"\x64\x00"
    b"\x07\x00\x00\x00command"
    b"\x1a\x00\x00\x00laser_bot_battle/Robot_msg"
    b"\x20\x00\x00\x00aa81278360e1bdd1ffce0a4efe0ae199"
    b"\x18\x01\x00\x00"
)


def test_the_bytes_are_those_of_the_protocol() -> None:
    assert COMMAND.encode() == COMMAND_BYTES


def test_the_bytes_of_the_protocol_are_understood() -> None:
    assert TopicInfo.decode(COMMAND_BYTES) == COMMAND


@pytest.mark.parametrize("length", range(len(COMMAND_BYTES)))
def test_a_cut_topic_info_is_an_error(length: int) -> None:
    with pytest.raises(ValueError, match="broken topic info"):
        TopicInfo.decode(COMMAND_BYTES[:length])


@pytest.mark.parametrize(
    "payload",
    [
        COMMAND_BYTES + b"\0",
        COMMAND_BYTES.replace(b"\x07\0\0\0", b"\xff\xff\xff\xff"),
        COMMAND_BYTES.replace(b"command", b"comm\xc3nd"),
    ],
    ids=["too long", "absurd string length", "not UTF-8"],
)
def test_a_broken_topic_info_is_an_error(payload: bytes) -> None:
    with pytest.raises(ValueError, match="broken topic info"):
        TopicInfo.decode(payload)
