"""What the tracker reads of its settings, and writes for ROS."""

import math

import pytest
from tf2_msgs.msg import TFMessage

from laser_bot_battle.geometry import Pose
from laser_bot_battle.settings import SettingsError
from server.camera.stream import Address
from server.overhead.messages import TF, transforms
from server.overhead.robots import Seen
from server.overhead.settings import Settings

CAMERA = "LASERBOT_OVERHEAD_CAMERA"


@pytest.mark.parametrize(
    ("url", "address"),
    [
        ("http://192.168.1.30:8090", Address("192.168.1.30", 8090, "/stream?extra_headers=1")),
        ("http://hall-camera.local/", Address("hall-camera.local", 80, "/stream?extra_headers=1")),
        ("http://[fe80::1]:81/cam/mjpg?fps=15", Address("fe80::1", 81, "/cam/mjpg?fps=15")),
    ],
)
def test_the_camera_is_a_ustreamer_or_any_stream(url: str, address: Address) -> None:
    assert Settings.from_env({CAMERA: url}).camera == address


@pytest.mark.parametrize(
    "url", ["rtsp://host/x", "http://u:p@host/x", "http://host:70000/x", "http://host/a b", "host"]
)
def test_what_is_no_address_is_refused(url: str) -> None:
    with pytest.raises(SettingsError, match=CAMERA):
        Settings.from_env({CAMERA: url})


def test_transforms_are_those_of_tf2() -> None:
    message = TFMessage()
    assert (TF.name, TF.md5sum) == (message._type, message._md5sum)
    robots = [Seen(7, Pose(1.5, 0.25, math.pi / 2), False), Seen(8, Pose(0, 0, 0), True)]
    message.deserialize(transforms(robots, 1234.5, 3))
    first, second = message.transforms
    assert (first.header.seq, first.header.stamp.to_sec(), first.header.frame_id) == (3, 1234.5, "floor")
    assert (first.child_frame_id, second.child_frame_id) == ("robot7", "robot8")
    assert (first.transform.translation.x, first.transform.translation.y) == (1.5, 0.25)
    rotation = first.transform.rotation
    assert (rotation.x, rotation.y) == (0, 0)
    assert 2 * math.atan2(rotation.z, rotation.w) == pytest.approx(math.pi / 2)
