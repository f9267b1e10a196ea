"""Tells the master where this robot's camera is: the ROS parameter /Robot<ID>/camera (docs/protocol-camera.md)."""

import contextlib
import logging

from rosgraph.network import get_host_name

from laser_bot_battle.master import Master, MasterError
from robot.settings import Settings

_log = logging.getLogger(__name__)


def camera_address(settings: Settings) -> str:
    """Below it the pictures are; "" for a robot without a camera."""
    if settings.camera_url or not settings.camera:
        return settings.camera_url
    return f"http://{get_host_name()}:{settings.camera_port}"


def tell_camera(settings: Settings, master: Master) -> None:
    """Also that there is none, in case that an earlier robot of this ID had one."""
    name, address = f"{master.node}/camera", camera_address(settings)
    try:
        if address:
            master.call("setParam", name, address)
        else:
            with contextlib.suppress(MasterError):  # there was none
                master.call("deleteParam", name)
    except (OSError, MasterError) as error:
        _log.warning("the master was not told where the camera is: %s", error)
