"""What happens in a conversation with a device: what it tells, and what the host does about it."""

from dataclasses import dataclass

from robot.rosserial.topic_info import TopicInfo


@dataclass(frozen=True)
class Send:
    """Bytes for the device."""

    data: bytes


@dataclass(frozen=True)
class DevicePublishes:
    info: TopicInfo


@dataclass(frozen=True)
class DeviceSubscribes:
    info: TopicInfo


@dataclass(frozen=True)
class ServiceInfo:
    """A ROS service between host and device: what the two TopicInfos of its requests and answers say."""

    name: str
    service_type: str  # for example std_srvs/SetBool
    request_id: int
    request_md5: str
    answer_id: int
    answer_md5: str
    buffer_size: int  # bytes; the longest message that the device can take


@dataclass(frozen=True)
class DeviceServes:
    """The device answers calls of this service."""

    info: ServiceInfo


@dataclass(frozen=True)
class DeviceCalls:
    """The device may call this service."""

    info: ServiceInfo


@dataclass(frozen=True)
class Message:
    """A serialised ROS message with one of the ids that the device sends: of a topic, or of a service."""

    topic_id: int
    payload: bytes


@dataclass(frozen=True)
class ParameterRequest:
    """The device waits for a parameter, which it gets by `robot.rosserial.parameters.answer`."""

    name: str


@dataclass(frozen=True)
class DeviceLog:
    """A log line of the sketch; level 0 debug, 1 info, 2 warning, 3 error, 4 fatal."""

    level: int
    text: str


@dataclass(frozen=True)
class Notice:
    """Something wrong that is worth a log line but changes nothing."""

    text: str


@dataclass(frozen=True)
class Lost:
    """The device does not answer any more, or cannot be used; the conversation has ended."""

    reason: str


Event = (
    Send
    | DevicePublishes
    | DeviceSubscribes
    | DeviceServes
    | DeviceCalls
    | Message
    | ParameterRequest
    | DeviceLog
    | Notice
    | Lost
)
