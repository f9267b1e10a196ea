"""Names of topics and services."""

import re

from server.rosbridge.wire import RequestError, brief

NAME = re.compile(r"/?[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)


def resolve(name: str) -> str:
    """The global ROS name: rosbridge lives in the root namespace. RequestError for what is no ROS name.

    Whatever is compared with a name (the gate's rules above all) must be compared with this form.
    """
    if len(name) > 200 or not NAME.fullmatch(name):
        raise RequestError(f"{brief(name)} is not a ROS name")
    return name if name.startswith("/") else f"/{name}"
