"""From what a device tells of its topics and services to the Python classes of their messages."""

from typing import Any

import genpy.message

from robot.rosserial.events import ServiceInfo
from robot.rosserial.topic_info import TopicInfo


def message_class(info: TopicInfo) -> Any:
    """The message class (a genpy.Message); ValueError if there is none, or one with other fields than the device's."""
    what = f"topic {info.topic_name!r}"
    found = _installed(genpy.message.get_message_class, info.message_type, what)
    _same(found, info.md5sum, info.message_type, what)
    return found


def service_class(info: ServiceInfo) -> Any:
    """The service class, with _request_class and _response_class; ValueError as above."""
    what = f"service {info.name!r}"
    found = _installed(genpy.message.get_service_class, info.service_type, what)
    _same(found._request_class, info.request_md5, f"the request of {info.service_type}", what)
    _same(found._response_class, info.answer_md5, f"the answer of {info.service_type}", what)
    return found


def _installed(find: Any, type_name: str, what: str) -> Any:
    try:
        found = find(type_name)
    except ValueError:  # no "package/name"
        found = None
    if found is None:
        raise ValueError(f"{what} of the device has type {type_name!r}, which is not installed here")
    return found


def _same(found: Any, md5sum: str, type_name: str, what: str) -> None:
    if found._md5sum != md5sum:
        raise ValueError(
            f"{what} of the device has another version of {type_name} "
            f"(md5 {md5sum}) than this host ({found._md5sum}): build the sketch with the same messages"
        )
