"""What a device has told of itself: its topics, and its services, each of which it tells in two parts."""

from robot.rosserial import ids
from robot.rosserial.events import DeviceCalls, DevicePublishes, DeviceServes, DeviceSubscribes, ServiceInfo
from robot.rosserial.frame import MAX_PAYLOAD
from robot.rosserial.topic_info import TopicInfo

MAX_TOPICS = 128  # that one device may tell; ros_lib has 50 on an Uno, a service counts as two

_OF_OUR_FIRMWARE = "laser_bot_battle/BoardHealth"  # it alone publishes this type
_SERVED = (ids.SERVED_REQUESTS, ids.SERVED_ANSWERS)
_CALLED = (ids.CALLED_REQUESTS, ids.CALLED_ANSWERS)
KINDS = (ids.PUBLISHER, ids.SUBSCRIBER, *_SERVED, *_CALLED)


class TooManyTopicsError(Exception):
    """The device tells more than it may."""


class Announcements:
    """Remembers what was told. A device that is asked again tells the same again."""

    def __init__(self) -> None:
        self.sent_by_device: set[int] = set()  # the ids of its messages
        self.largest_buffer = 0  # bytes
        self.is_our_firmware = False
        self._told: set[tuple[int, TopicInfo]] = set()
        self._halves: dict[tuple[int, str], TopicInfo] = {}  # by kind and name of the service

    def told(self, kind: int, payload: bytes) -> DevicePublishes | DeviceSubscribes | DeviceServes | DeviceCalls | None:
        """What follows from a TopicInfo of that kind: nothing, while the other half of a service is missing.

        ValueError says why it cannot be used; TooManyTopicsError.
        """
        info = TopicInfo.decode(payload)
        if info.topic_id < ids.FIRST_TOPIC:
            raise ValueError(f"topic {info.topic_name!r} with the reserved id {info.topic_id} ignored")
        if (kind, info) not in self._told:
            if len(self._told) >= MAX_TOPICS:
                raise TooManyTopicsError(f"the device tells more than {MAX_TOPICS} topics")
            self._told.add((kind, info))
        if info.buffer_size <= 0:
            raise ValueError(f"topic {info.topic_name!r} with a buffer of {info.buffer_size} bytes refused")
        self.largest_buffer = max(self.largest_buffer, info.buffer_size)
        if kind in (ids.PUBLISHER, ids.SERVED_ANSWERS, ids.CALLED_REQUESTS):
            self.sent_by_device.add(info.topic_id)
        if kind == ids.PUBLISHER:
            self.is_our_firmware |= info.message_type == _OF_OUR_FIRMWARE
            return DevicePublishes(info)
        if kind == ids.SUBSCRIBER:
            return DeviceSubscribes(info)
        return self._service(kind, info)

    def _service(self, kind: int, info: TopicInfo) -> DeviceServes | DeviceCalls | None:
        served = kind in _SERVED
        self._halves[kind, info.topic_name] = info
        request, answer = (self._halves.get((half, info.topic_name)) for half in (_SERVED if served else _CALLED))
        if request is None or answer is None:
            return None
        service = ServiceInfo(
            info.topic_name,
            request.message_type,
            request.topic_id,
            request.md5sum,
            answer.topic_id,
            answer.md5sum,
            min((request if served else answer).buffer_size, MAX_PAYLOAD),
        )
        return DeviceServes(service) if served else DeviceCalls(service)
