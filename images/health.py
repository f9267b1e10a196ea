"""Whether the service of this container works: exit code 0 or 1, asked of the service itself.

The images' HEALTHCHECK. Which service it is follows from the container's main process, so that one check fits every
service of an image.
"""

import contextlib
import http.client
import os
import re
import sys
import xmlrpc.client
from collections.abc import Callable
from pathlib import Path

TIMEOUT = 3.0  # s


class UnhealthyError(Exception):
    """The service does not do its work; the text says what is wrong."""


def main() -> int:
    command = Path("/proc/1/cmdline").read_text().split("\0")
    check = next((CHECKS[word] for word in command if word in CHECKS), None)
    if check is None:
        print("health: no check for", " ".join(command))
        return 1
    try:
        check()
    except (OSError, http.client.HTTPException, xmlrpc.client.Error, UnhealthyError) as error:
        print(f"health: {error or type(error).__name__}")
        return 1
    return 0


def port(variable: str, default: int) -> int:
    return int(os.environ.get(variable) or default)


def master() -> str:
    return os.environ.get("LASERBOT_MASTER") or "laser_bot_master.local"


def own_host() -> str:
    """Where a service of this container listens."""
    bind = os.environ.get("LASERBOT_BIND") or ""
    return "localhost" if bind in {"", "0.0.0.0", "::"} else bind


def http_status(host: str, number: int, method: str, path: str) -> int:
    connection = http.client.HTTPConnection(host, number, timeout=TIMEOUT)
    try:
        connection.request(method, path)
        return connection.getresponse().status
    finally:
        connection.close()


def expect(status: int, wanted: int) -> None:
    if status != wanted:
        raise UnhealthyError(f"HTTP status {status}, not {wanted}")


def ros_master() -> None:
    """The master answers its API: this one, not another one at its port of the host."""
    number = int(main_argument("-p", "11311"))
    ask_node(f"http://localhost:{number}", "getPid")
    expect_listener(number)


def web_server() -> None:
    """The referee tells the state of the game through the web server."""
    expect(http_status(own_host(), port("LASERBOT_WEB_PORT", 5000), "POST", "/updateGameStatus"), 200)


def rosbridge() -> None:
    """The WebSocket server answers plain HTTP with `Upgrade Required`."""
    expect(http_status(own_host(), port("LASERBOT_ROSBRIDGE_PORT", 9090), "GET", "/"), 426)


def robot() -> None:
    """The serial node, which runs only with a working Arduino and an ID, answers under its name in the ROS network."""
    nodes = {number: name for number in processes() if (name := serial_node_name(number))}
    if not nodes:
        raise UnhealthyError("no serial node: no Arduino, or no ID from the server")
    master_uri = os.environ.get("ROS_MASTER_URI") or f"http://{master()}:11311"
    for number, name in nodes.items():
        if ask_node(str(ask_node(master_uri, "lookupNode", name)), "getPid") != number:
            raise UnhealthyError(f"another node took the name {name}")


def arena() -> None:
    expect(http_status(own_host(), port("LASERBOT_ARENA_PORT", 8080), "GET", "/"), 200)


def avr_robot() -> None:
    """Its serial line is open. To connect would take it from the robot, so the kernel is asked."""
    expect_listener(int(main_argument("--tcp", "").rpartition(":")[2]))


def bot() -> None:
    """A bot is its page's user: the server must be there."""
    expect(http_status(master(), port("LASERBOT_WEB_PORT", 5000), "GET", "/"), 200)


CHECKS: dict[str, Callable[[], None]] = {
    "/usr/bin/rosmaster": ros_master,
    "server.main": web_server,
    "server.rosbridge": rosbridge,
    "robot.id_service_client": robot,
    "sim.arena": arena,
    "avr_robot": avr_robot,
    "sim.bot": bot,
}


class TimedTransport(xmlrpc.client.Transport):
    def make_connection(self, host: tuple[str, dict[str, str]] | str) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = TIMEOUT
        return connection


def ask_node(uri: str, method: str, *arguments: str) -> object:
    """Call the API of a ROS master or node (wiki.ros.org/ROS/Slave_API); its value."""
    with xmlrpc.client.ServerProxy(uri, transport=TimedTransport()) as node:
        code, text, value = getattr(node, method)("/health", *arguments)
    if code != 1:
        raise UnhealthyError(text)
    return value


def processes() -> list[int]:
    return [int(path.name) for path in Path("/proc").iterdir() if path.name.isdigit()]


def serial_node_name(process: int) -> str | None:
    """The ROS name of a process if it is a serial node."""
    try:
        command = Path(f"/proc/{process}/cmdline").read_text()
    except OSError:  # it has just ended
        return None
    name = re.search(r"\0__name:=([^\0]+)", command)
    return f"/{name[1]}" if name and "\0robot.serial_node\0" in command else None


def main_argument(option: str, default: str) -> str:
    """The value of an option of the container's main process."""
    command = Path("/proc/1/cmdline").read_text().split("\0")
    return command[command.index(option) + 1] if option in command else default


def expect_listener(number: int) -> None:
    """The container's main process listens at this TCP port (proc(5): the files of a process, net/tcp)."""
    own = set()
    for file in Path("/proc/1/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):  # it has just been closed
            own.add(os.readlink(file))
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in Path(table).read_text().splitlines()[1:]:
            _, local, _, state, *_, inode = line.split()[:10]
            if state == "0A" and int(local.rpartition(":")[2], 16) == number and f"socket:[{inode}]" in own:
                return
    raise UnhealthyError(f"the service does not listen at port {number}")


if __name__ == "__main__":
    sys.exit(main())
