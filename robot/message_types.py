"""From a device's topic info to the Python class of its messages."""

from typing import Any

import genpy.message

from robot.rosserial.topic_info import TopicInfo


def message_class(info: TopicInfo) -> Any:
    """The message class (a genpy.Message); ValueError if there is none, or one with other fields than the device's."""
    try:
        found = genpy.message.get_message_class(info.message_type)
    except ValueError:  # no "package/name"
        found = None
    if found is None:
        raise ValueError(
            f"topic {info.topic_name!r} of the device has type {info.message_type!r}, which is not installed here"
        )
    if found._md5sum != info.md5sum:
        raise ValueError(
            f"topic {info.topic_name!r} of the device has another version of {info.message_type} "
            f"(md5 {info.md5sum}) than this host ({found._md5sum}): build the sketch with the same messages"
        )
    return found
