"""What the tracker tells ROS: /positions, /overhead/view, and /tf for the tools of ROS."""

import io
import math
import struct
from collections.abc import Iterable, Sequence
from typing import Any

from laser_bot_battle.floor import Floor
from laser_bot_battle.msg import OverheadView, Positions, RobotPosition
from server.overhead.robots import Seen
from server.overhead.view import View
from tcpros.specs import TypeSpec

FRAME = "floor"  # m from its lower left corner, x to the right, y up, z towards the camera

_LINE = "=" * 80
# tf2_msgs and geometry_msgs are not where the game runs, so their one message is written here
TF = TypeSpec(
    "tf2_msgs/TFMessage",
    "94810edda583a504dfda3829e70d7eec",
    f"""geometry_msgs/TransformStamped[] transforms
{_LINE}
MSG: geometry_msgs/TransformStamped
Header header
string child_frame_id
geometry_msgs/Transform transform
{_LINE}
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
{_LINE}
MSG: geometry_msgs/Transform
geometry_msgs/Vector3 translation
geometry_msgs/Quaternion rotation
{_LINE}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
{_LINE}
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
""",
)


def packed(message: Any) -> bytes:
    """A generated message, serialized."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def positions(floor: Floor, robots: Iterable[Seen]) -> bytes:
    return packed(
        Positions(
            width=floor.width,
            height=floor.height,
            walls=[number for wall in floor.walls for number in wall],
            robots=[RobotPosition(seen.robot, *seen.place.point, seen.place.heading) for seen in robots],
        )
    )


def sight(view: View | None, tag_height: float) -> bytes:
    """An OverheadView: with a width of 0 if the camera's view is not known."""
    if view is None:
        return packed(OverheadView())
    return packed(
        OverheadView(
            width=view.size[0],
            height=view.size[1],
            homography=view.homography.ravel().tolist(),
            bend=view.bend,
            camera=view.camera.tolist(),
            tag_height=tag_height,
        )
    )


def transforms(robots: Sequence[Seen], now: float, number: int) -> bytes:
    """A tf2_msgs/TFMessage from the floor to each robot; `now` is Unix time in s, `number` the message's."""
    seconds, fraction = divmod(now, 1)
    data = struct.pack("<I", len(robots))
    for seen in robots:
        (x, y), heading = seen.place.point, seen.place.heading
        data += struct.pack("<III", number & 0xFFFFFFFF, int(seconds), int(fraction * 1e9))
        data += _text(FRAME) + _text(f"robot{seen.robot}")
        data += struct.pack("<7d", x, y, 0, 0, 0, math.sin(heading / 2), math.cos(heading / 2))
    return data


def _text(text: str) -> bytes:
    return struct.pack("<I", len(text)) + text.encode()
