"""A clear word about libraries that this machine lacks, instead of a traceback."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module

PACKAGES = {
    "zeroconf": "apt install python3-zeroconf",
    "ifaddr": "apt install python3-ifaddr",
    "serial": "apt install python3-serial",
    "requests": "apt install python3-requests",
    "rospy": "apt install python3-rospy",
    "rosgraph": "apt install python3-rosgraph",
    "genpy": "apt install python3-genpy",
    "std_msgs": "apt install python3-std-msgs",
    "laser_bot_battle": "run ci/messages, then set PYTHONPATH=build/python",
    "tcpros": "run ci/messages, then set PYTHONPATH=build/python",
}


@contextmanager
def missing_explained() -> Iterator[None]:
    """Around imports: a library that is not installed ends the program with one line and exit code 1.

    Without its generated classes laser_bot_battle is still found, as the plain folder of the ROS package.
    """
    try:
        yield
    except ImportError as error:
        package = (error.name or "").partition(".")[0]
        raise SystemExit(f"{error}: {PACKAGES.get(package, 'is it installed for this Python?')}") from None


def require(*modules: str) -> None:
    """Make sure that other programs of the robot will find these modules."""
    with missing_explained():
        for module in modules:
            import_module(module)
