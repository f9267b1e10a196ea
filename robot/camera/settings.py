"""The camera's settings, from environment variables."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from laser_bot_battle import variables
from laser_bot_battle.addresses import check_interface

VARIABLES = (
    variables.CAMERA,
    variables.CAMERA_SIZE,
    variables.CAMERA_RATE,
    variables.CAMERA_QUALITY,
    variables.CAMERA_PORT,
    variables.ARENA_NAME,
    variables.MASTER,
    variables.ROS_MASTER_URI,
    variables.INTERFACE,
    variables.RETRY,
    variables.LOG_LEVEL,
    variables.LOG_FORMAT,
    variables.ALIVE_FILE,
)
LIBCAMERA = "libcamera"
NO_CAMERA = Path(__file__).parent / "no_camera.jpg"


def find_libcamera(root: Path = Path("/")) -> Path | None:
    """The library by which programs that know V4L2 only open libcamera's cameras: Debian's package libcamera-v4l2."""
    places = ("usr/libexec/*/libcamera/v4l2-compat.so", "usr/lib/*/v4l2-compat.so")  # of Debian 13 and 12
    return next((path for place in places for path in root.glob(place)), None)


@dataclass(frozen=True)
class CameraSettings:
    """What the camera is and what its pictures are like."""

    device: str  # a path, LIBCAMERA, or "" for none
    size: tuple[int, int]  # width, height
    rate: int  # pictures/s
    quality: int  # 1 to 100
    port: int

    @classmethod
    def from_env(cls, env: Mapping[str, str]) -> Self:
        """SettingsError names the variable whose value cannot be used."""
        check_interface(env)
        return cls(
            device=variables.CAMERA.read(env),
            size=variables.CAMERA_SIZE.read(env),
            rate=variables.CAMERA_RATE.read(env),
            quality=variables.CAMERA_QUALITY.read(env),
            port=variables.CAMERA_PORT.read(env),
        )

    def command(self, socket: Path) -> list[str]:
        """ustreamer on a Unix `socket`. It opens a camera that is pulled out again as soon as it is back."""
        words = [
            "ustreamer",
            f"--resolution={self.size[0]}x{self.size[1]}",
            f"--desired-fps={self.rate}",
            f"--quality={self.quality}",
            f"--unix={socket}",
            "--unix-rm",
            "--unix-mode=600",
            f"--blank={NO_CAMERA}",
            "--slowdown",  # nobody looks, one picture a second
            "--device-timeout=3",  # s; a camera that is frozen is opened anew
            "--exit-on-parent-death",
        ]
        if self.device == LIBCAMERA:  # as its libcamerify does, whose package brings all of Qt
            return ["env", f"LD_PRELOAD={find_libcamera()}", *words, "--device=/dev/video0"]
        # the JPEGs of the camera's own hardware; of one that has none, the processor makes them
        return [*words, f"--device={self.device}", "--format=MJPEG", "--encoder=HW"]
