"""A whole battle on one machine: starts it, waits until all are ready, says where to play, stops it on Ctrl-C.

roslaunch runs the parts of the battle (sim/launch/demo.launch). This program looks after what roslaunch does not: the
ROS master (roslaunch would end with one that it started), ports in use, being ready, plain words for people, and that
nothing is left behind.
"""

import argparse
import ctypes
import http.client
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import NoReturn

import segno

from laser_bot_battle.addresses import reachable_addresses
from laser_bot_battle.settings import Variable, describe, read_or_exit
from laser_bot_battle.variables import (
    ARENA,
    BIND,
    BOT_ROBOTS,
    DATA,
    FLOOR,
    LIGHT,
    OPERATOR_TOKEN,
    OVERHEAD_CAMERA,
    OVERHEAD_HEIGHT,
    RELAY,
    ROS,
    ROSBRIDGE,
    ROSTER,
    WEB,
)
from sim.arena.ambient import Ambient, add_options
from sim.arena.overhead import conditions
from sim.arena.overhead.conditions import Conditions
from sim.arena.world import MAX_ROBOTS
from sim.demo_settings import HOST, VARIABLES, Settings

ROOT = Path(__file__).resolve().parent.parent
READY_WITHIN = 90.0  # s; a slow machine needs 20
STOP_WITHIN = 20.0  # s; roslaunch gives its nodes 15 s before it kills them

PR_SET_PDEATHSIG = 1
PR_SET_CHILD_SUBREAPER = 36


class DemoError(Exception):
    """The demo cannot go on; the message says why and what to do."""


class Interrupted(Exception):  # noqa: N818 - not an error
    """The user wants to stop (Ctrl-C, SIGTERM, closed terminal)."""


def request(port: int, method: str, path: str, timeout: float = 1.0) -> tuple[int, str] | None:
    """The status code and the body of the answer from HOST:port, None when nobody answers yet."""
    connection = http.client.HTTPConnection(HOST, port, timeout=timeout)
    try:
        connection.request(method, path)
        response = connection.getresponse()
        return response.status, response.read().decode()
    except (OSError, http.client.HTTPException):
        return None
    finally:
        connection.close()


class Demo:
    """The running demo: the ROS master, roslaunch and all that it started."""

    def __init__(
        self, robots: int, bots: int, light: Ambient, settings: Settings, folder: Path, *, overhead: Conditions | None
    ) -> None:
        """`folder` is empty. With `overhead`, robots are found by the picture of a camera above the floor."""
        self.robots, self.bots, self.bind, self.ports = robots, bots, settings.bind, settings.ports
        for number in range(robots):
            (folder / f"virtual{number}").mkdir()
        self.environment = {
            **os.environ,
            BIND.name: settings.bind,
            **({OPERATOR_TOKEN.name: settings.new_token} if settings.new_token else {}),
            **{variable: str(port) for variable, port in settings.ports.items()},
            LIGHT.name: settings.light,
            FLOOR.name: settings.floor,
            **(self.camera(overhead) if overhead else {}),
            BOT_ROBOTS.name: " ".join(str(number) for number in range(robots - bots, robots)),  # people get the first
            DATA.name: str(folder / "data"),
            # the number painted on each virtual robot is its ID
            ROSTER.name: " ".join(f"virtual{number}={number}" for number in range(robots)),
            "PATH": f"{ROOT / '.venv' / 'bin'}:{os.environ.get('PATH', os.defpath)}",
            "ROS_PACKAGE_PATH": str(ROOT / "laser_bot_battle"),  # roslaunch searches all that is below
            "ROS_MASTER_URI": f"http://{HOST}:{settings.ports[ROS.name]}",
            "ROS_HOME": str(folder / "ros"),
            "ROS_LOG_DIR": str(folder / "ros" / "log"),
            "PYTHONUNBUFFERED": "1",
        }
        self.environment.pop("ROS_HOSTNAME", None)
        self.log = folder / "log"
        self.master = self.start_master()
        self.roslaunch = self.start(
            "/usr/bin/roslaunch",
            "--wait",  # for the master
            "--run_id=demo",  # else it waits for another roslaunch to name the run
            str(ROOT / "sim" / "launch" / "demo.launch"),
            f"robots:={robots}",
            f"run_dir:={folder}",
            *([f"ambient:={light.options}"] if light.options else []),
            *(["overhead:=true", f"camera:={overhead.options}"] if overhead else []),
        )

    def camera(self, conditions: Conditions) -> dict[str, str]:
        """The tracker's settings."""
        address = f"http://{HOST}:{self.ports[ARENA.name]}/overhead/stream"
        return {OVERHEAD_CAMERA.name: address, OVERHEAD_HEIGHT.name: f"{conditions.height:g}"}

    def start(self, *words: str, ros_ip: str = HOST) -> subprocess.Popen[bytes]:
        """A program in Python, which writes into our log. It listens on this machine only if `ros_ip` is loopback."""
        with self.log.open("ab") as log:
            return subprocess.Popen(
                ["/usr/bin/python3", *words],
                env={**self.environment, "ROS_IP": ros_ip},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                # Ctrl-C reaches this program only, which then stops the rest in order
                start_new_session=True,
                preexec_fn=die_with_parent,  # noqa: PLW1509 - this program has one thread
            )

    def start_master(self) -> subprocess.Popen[bytes]:
        return self.start("-m", "server.ros.master", "-p", str(self.ports[ROS.name]), ros_ip=self.bind)

    def supervise(self) -> None:
        """Start the master again if it was ended; the nodes find it. Raises DemoError when roslaunch has ended, or the
        master cannot work."""
        code = self.master.poll()
        if self.roslaunch.poll() is not None or (code or 0) > 0:
            tail = self.log.read_text(errors="replace").splitlines()[-15:]
            raise DemoError("\n  ".join([f"the demo has ended by itself. The end of {self.log}:", *tail]))
        if code is not None:
            say("The ROS master has ended: starting it again.")
            self.master = self.start_master()

    def steps(self) -> dict[str, Callable[[], bool]]:
        """What must be ready before anyone can play, in the order in which it starts, each with its check."""
        steps: dict[str, Callable[[], bool]] = {
            "web server": lambda: self.answers(WEB, 200),
            "rosbridge": lambda: self.answers(ROSBRIDGE, 426),  # to plain HTTP: Upgrade Required
            "cameras": lambda: self.answers(RELAY, 426),
            "arena": lambda: self.answers(ARENA, 200),
            counted(self.robots, "virtual robot"): lambda: self.registered_robots() >= self.robots,
        }
        if self.bots:
            steps[counted(self.bots, "bot")] = lambda: self.players() >= self.bots
        return steps

    def answers(self, port: Variable[int], status: int) -> bool:
        answer = request(self.ports[port.name], "GET", "/")
        return answer is not None and answer[0] == status

    def players(self) -> int:
        """People and bots that are signed in."""
        answer = request(self.ports[WEB.name], "POST", "/updateGameStatus")
        return len(json.loads(json.loads(answer[1])["users"])) if answer else 0

    def registered_robots(self) -> int:
        answer = request(self.ports[WEB.name], "POST", "/getAvailableRobots")
        return self.players() + (int(json.loads(answer[1])["availableR"]) if answer else 0)

    def wait_until_ready(self) -> None:
        """Say what is ready as soon as it is. Raises DemoError when something is not ready in time."""
        deadline = time.monotonic() + READY_WITHIN
        missing = self.steps()
        while missing:
            self.supervise()
            for step in [step for step, is_up in missing.items() if is_up()]:
                say(f"  ready: {step}")
                del missing[step]
            if missing and time.monotonic() > deadline:
                raise DemoError(f"not ready after {READY_WITHIN:.0f} s: {', '.join(missing)}. {self.log} says more.")
            time.sleep(0.1)

    def wait(self) -> None:
        """Supervise for ever. Raises DemoError when roslaunch has ended, which it should not."""
        while True:
            self.supervise()
            time.sleep(0.5)

    def stop(self) -> None:
        """End roslaunch with its nodes, then the master, and make sure that no process is left."""
        deadline = time.monotonic() + STOP_WITHIN
        # not by Popen.wait(): the signal may have interrupted poll(), which then holds its lock for ever
        for program, left in ((self.roslaunch, 1), (self.master, 0)):
            program.send_signal(signal.SIGINT)
            while len(children()) > left and time.monotonic() < deadline:
                reap()
                time.sleep(0.02)
        for pid in children():
            os.kill(pid, signal.SIGKILL)
        while children():
            reap()
            time.sleep(0.02)


def empty_folder(web_port: int) -> Path:
    """A new folder for the files of this demo. Each web port has its own, so that two demos may run."""
    folder = ROOT / "build" / f"demo-{web_port}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def die_with_parent() -> None:
    """In the child: have the kernel send SIGINT when this program dies, even by SIGKILL."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGINT)


def children() -> list[int]:
    """Direct children, those inherited from children that died among them (we are their subreaper)."""
    return [int(pid) for pid in Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()]


def reap() -> None:
    """Collect the exit codes of ended children."""
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        pass


def say(text: str) -> None:
    print(text, flush=True)


def counted(number: int, thing: str) -> str:
    return f"{number} {thing}" + "s" * (number != 1)


def who_can_play(people: int) -> str:
    """What to do for more players, when that many robots are left to people."""
    if people == 0:
        return "Bots drive all robots: watch them, or start with BOTS=0 to play."
    if people == 1:
        return "One person can play. For two: more ROBOTS or BOTS=0, and another browser or a private window."
    return f"{people} people can play, each in another browser or a private window."


def desk(settings: Settings) -> str:
    """Where operators lead the evening, and by which token."""
    token = f"token {settings.new_token}" if settings.new_token else "with your token"
    return f"http://localhost:{settings.ports[WEB.name]}/operator   the operator's desk, {token}"


def from_the_network(settings: Settings) -> str:
    """Where other computers and phones find the game, if they are to; a terminal shows a code for phones, too."""
    pages = [f"http://{address.ip}:{settings.ports[WEB.name]}" for address in reachable_addresses(settings.bind)]
    if not pages:
        return ""
    text = f"In this network the game is at\n  {'   '.join(pages)}\n"
    if not sys.stdout.isatty():
        return text
    code = io.StringIO()
    segno.make(pages[0]).terminal(code, compact=True, border=2)
    return text + code.getvalue()


def count(least: int) -> Callable[[str], int]:
    """Reads a number of robots."""

    def read(text: str) -> int:
        if not (text.isascii() and text.isdigit() and least <= int(text) <= MAX_ROBOTS):
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} to {MAX_ROBOTS}")
        return int(text)

    return read


class Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """In one line: `make demo` names the options otherwise, so the usage would not help."""
        self.exit(2, f"make demo: {message.removeprefix('argument ')} ({self.prog} --help lists all options)\n")


def on_signal(signum: int, frame: FrameType | None) -> None:
    raise Interrupted


def main() -> int:
    parser = Parser(
        "ci/demo",
        description="A whole battle on this machine, until Ctrl-C.",
        epilog=describe(*VARIABLES),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--robots", type=count(1), default=2, help="virtual robots with the real firmware (default 2)")
    parser.add_argument("--bots", type=count(0), default=1, help="robots that a program plays (default 1)")
    add_options(parser)
    parser.add_argument(
        "--overhead", action="store_true", help="robots get their places by the picture of a camera above the floor"
    )
    conditions.add_options(parser)
    options = parser.parse_args()
    if options.bots > options.robots:
        parser.error(
            f"{counted(options.bots, 'bot')} cannot play with {counted(options.robots, 'robot')}: start more robots"
        )
    settings = read_or_exit("make demo", Settings.from_env)
    for signum in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(signum, on_signal)
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
    demo = None
    try:
        folder = empty_folder(settings.ports[WEB.name])
        say(f"Starting the battle: {counted(options.robots, 'virtual robot')}, {counted(options.bots, 'bot')} ...")
        demo = Demo(
            options.robots,
            options.bots,
            Ambient.of(options),
            settings,
            folder,
            overhead=Conditions.of(options) if options.overhead else None,
        )
        demo.wait_until_ready()
        say(
            f"\nReady. Open\n"
            f"  http://localhost:{settings.ports[WEB.name]}   the game\n"
            f"  http://localhost:{settings.ports[ARENA.name]}   the simulator's own page\n"
            f"  {desk(settings)}\n"
            f"{from_the_network(settings)}"
            f"{who_can_play(options.robots - options.bots)}\n"
            f"Ctrl-C stops everything. The log: {demo.log}"
        )
        demo.wait()
    except Interrupted:
        say("\nStopping ...")
    except DemoError as error:
        print(f"make demo: {error}", file=sys.stderr)
        return 1
    finally:
        for signum in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(signum, signal.SIG_IGN)
        if demo:
            demo.stop()
    say("Stopped.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
