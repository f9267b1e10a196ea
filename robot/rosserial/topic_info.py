"""TopicInfo: how a device tells the host about one of its topics (payload of frames 0 and 1).

u16 topic id, three strings (name, type, md5; each a u32 length and its bytes), i32 buffer size; all little-endian.
"""

import struct
from dataclasses import dataclass


@dataclass(frozen=True)
class TopicInfo:
    topic_id: int
    topic_name: str
    message_type: str  # for example std_msgs/Empty
    md5sum: str
    buffer_size: int  # bytes; the longest message that the device can take or send

    def encode(self) -> bytes:
        strings = (text.encode() for text in (self.topic_name, self.message_type, self.md5sum))
        packed = b"".join(struct.pack("<I", len(text)) + text for text in strings)
        return struct.pack("<H", self.topic_id) + packed + struct.pack("<i", self.buffer_size)

    @classmethod
    def decode(cls, payload: bytes) -> "TopicInfo":
        """ValueError if the payload is no TopicInfo."""
        try:
            (topic_id,) = struct.unpack_from("<H", payload)
            position = 2
            strings: list[str] = []
            for _ in range(3):
                (length,) = struct.unpack_from("<I", payload, position)
                position += 4 + length
                strings.append(payload[position - length : position].decode())
            (buffer_size,) = struct.unpack_from("<i", payload, position)
        except (struct.error, UnicodeDecodeError) as error:
            raise ValueError(f"broken topic info of {len(payload)} bytes: {error}") from None
        if len(payload) != position + 4:
            raise ValueError(f"broken topic info: {len(payload)} bytes instead of {position + 4}")
        name, message_type, md5sum = strings
        return cls(topic_id, name, message_type, md5sum, buffer_size)
