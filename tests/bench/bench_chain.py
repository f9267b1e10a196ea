"""The whole chain, measured: key to coil and light to life, hop by hop, stop times, stepper speed; 4 virtual robots,
real Chromium. Key to coil once more in a second battle, whose programs take no real-time priority.

Run by `make bench`. Robot 3 is started here, with a trace of its pins and a light switch in place of the arena; robots
0 to 2 are a normal demo and are driven at 40 Hz all the while. Times are CLOCK_MONOTONIC of this machine throughout.
"""

import contextlib
import itertools
import os
import queue
import signal
import socket
import statistics
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright
from playwright.sync_api import TimeoutError as PageTimeout

from sim.arena.protocol import carrier
from tests.bench.taps import Passed, Taps, first_after, first_change
from tests.browser.conftest import CHROMIUM, FLAGS
from tests.support.battle import Battle
from tests.support.play import keep_turning
from tests.support.player import Player
from tests.support.polling import until
from tests.support.processes import command_line, descendants
from tests.support.programs import ROOT, Program

AVR_HZ = 16_000_000
ROBOT = 3  # the one with a trace
PRESSES = 200
HITS = 90  # of a player with 100 %
SHOTS_APART = 0.6  # s; a shooter can fire once in 0.5 s
MARKS = 15  # of a packet
DARKNESS = 4000  # us; a robot that sees a packet waits for news until it is certain that this is its end
CUTS = 10
STILL = 0.15  # s without a step = standing

# Runs in the page: wall-clock times (ms) of key presses, of the commands that are sent, and of changes of what the list
# of players says of the driver.
STOPWATCH = """() => {
  window.stopwatch = {keys: [], sent: [], lives: []};
  const clock = stamp => performance.timeOrigin + stamp;
  addEventListener('keydown', event => { if (!event.repeat) stopwatch.keys.push(clock(event.timeStamp)); }, true);
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (text) {
    if (String(text).includes('/command')) stopwatch.sent.push(clock(performance.now()));
    return send.call(this, text);
  };
  let before = '';
  const look = () => {
    const users = [...document.getElementById('userList').children];
    const now = users.find(user => user.textContent.includes('Driver'))?.textContent;
    if (now !== before) { before = now; stopwatch.lives.push(clock(performance.now())); }
  };
  new MutationObserver(look).observe(document.getElementById('userList'),
    {subtree: true, childList: true, characterData: true, attributes: true});
}"""


class TracedRobot:
    """Robot 3: the firmware in the simulator with a trace, its serial node, and a light switch."""

    def __init__(self, battle: Battle, folder: Path, priority: str) -> None:
        self.steps: queue.SimpleQueue[tuple[float, int, str]] = queue.SimpleQueue()  # (s, AVR cycles, wheel)
        self.dark: queue.SimpleQueue[float] = queue.SimpleQueue()  # s, when light has ended
        self.line: dict[str, list[Passed]] = {"uart-in": [], "uart-out": []}  # bytes to the AVR, from the AVR
        arena = socket.create_server(("127.0.0.1", 0))
        serial = folder / "ttyACM0"
        self.simulator = subprocess.Popen(
            [
                ROOT / "build/sim/avr_robot",
                "--firmware",
                ROOT / "build/firmware/laserbot.elf",
                "--name",
                "virtual3",
                "--serial",
                serial,
                "--arena",
                f"127.0.0.1:{arena.getsockname()[1]}",
                "--trace",
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, "LASERBOT_PRIORITY": priority},
        )
        self.link = arena.accept()[0]
        arena.close()
        threading.Thread(target=self._read_trace, daemon=True).start()
        threading.Thread(target=self._drain_link, daemon=True).start()
        until(serial.exists, 5)
        self.client = Program.python(
            "robot.id_service_client",
            env={
                **{variable: str(port) for variable, port in battle.ports.items()},
                "PYTHONPATH": f"{ROOT}:{ROOT / 'build' / 'python'}",
                "LASERBOT_MASTER": "127.0.0.1",
                "LASERBOT_ROBOT_NAME": "virtual3",
                "LASERBOT_PRIORITY": priority,
                "LASERBOT_SERIAL": str(serial),
                "ROS_MASTER_URI": f"http://127.0.0.1:{battle.ports['LASERBOT_ROS_PORT']}",
                "ROS_IP": "127.0.0.1",
                "ROS_LOG_DIR": str(folder),
                "ROS_HOME": str(folder),
            },
        )

    def _read_trace(self) -> None:
        assert self.simulator.stdout
        for line in self.simulator.stdout:
            stamp, cycles, event, *words = line.split()
            if event == "coil":
                self.steps.put((int(stamp) / 1e9, int(cycles), words[0]))
            elif event == "light" and words[0] == "0":
                self.dark.put(int(stamp) / 1e9)
            elif event in self.line:
                self.line[event].append(Passed(int(stamp) / 1e9, words))

    def _drain_link(self) -> None:
        with contextlib.suppress(OSError):
            while self.link.recv(4096):
                pass

    def shine_packet(self, shooter: int) -> None:
        """A packet of coded light of that robot falls on it, from now on."""
        cycle = int(time.monotonic() * AVR_HZ)
        lines = []
        for on, length in packet(shooter):
            lines.append(carrier(0, on, cycle))
            cycle += length * AVR_HZ // 1_000_000
        self.link.sendall(b"".join([*lines, carrier(0, False, cycle)]))

    def packet_seen(self) -> float:
        """When (s) the last mark of the packet that now comes has ended."""
        return [self.dark.get(timeout=2) for _ in range(MARKS)][-1]

    def light(self, on: bool) -> None:
        self.link.sendall(b"light 1\n" if on else b"light 0\n")

    def first_step_after(self, moment: float, seconds: float = 2.0) -> float:
        """The time of the first half-step after `moment`. Raises queue.Empty when there is none in time."""
        while True:
            stamp = self.steps.get(timeout=seconds)[0]
            if stamp > moment:
                return stamp

    def last_step(self) -> float:
        """Wait until the wheels stand; the time of their last half-step (0 when there was none)."""
        last = 0.0
        with contextlib.suppress(queue.Empty):
            while True:
                last = self.steps.get(timeout=STILL)[0]
        return last

    def serial_node(self) -> int:
        """The process of robot 3's serial node."""
        (node,) = [one for one in descendants(self.client.process.pid) if "robot.serial_node" in command_line(one)]
        return int(node.pid)

    def stop(self) -> None:
        self.client.stop()
        self.simulator.terminate()
        self.simulator.wait()
        self.link.close()


def packet(shooter: int) -> list[tuple[bool, int]]:
    """Whether there is carrier, and for how long (us): MilesTag II with team 0 and damage code 0."""
    bits = f"0{shooter:07b}000000"
    marks = [2400, *(1200 if bit == "1" else 600 for bit in bits)]
    edges = [edge for mark in marks for edge in ((True, mark), (False, 600))]
    return [*edges[:-1], (False, DARKNESS)]


def report(what: str, seconds: list[float], budget: str) -> None:
    """One line: count, p50, p99 and worst in ms."""
    ordered = sorted(1000 * value for value in seconds)
    p99 = ordered[min(len(ordered) - 1, int(0.99 * len(ordered)))]
    print(
        f"{what:<52} n={len(ordered):<4} p50 {statistics.median(ordered):6.1f} ms   p99 {p99:6.1f} ms   "
        f"max {ordered[-1]:6.1f} ms   (budget {budget})",
        flush=True,
    )


class Hops:
    """Where the time goes: from each point of the chain to the next one, whose name the hop has."""

    def __init__(self, *names: str) -> None:
        self._times: dict[str, list[float]] = {name: [] for name in names}

    def add(self, *moments: float) -> None:
        """s; the start, and then one for each name."""
        for times, (earlier, later) in zip(self._times.values(), itertools.pairwise(moments), strict=True):
            times.append(later - earlier)

    def report(self) -> None:
        for name, seconds in self._times.items():
            ordered = sorted(1000 * value for value in seconds)
            p99 = ordered[min(len(ordered) - 1, int(0.99 * len(ordered)))]
            print(f"    -> {name:<45}        p50 {statistics.median(ordered):6.1f} ms   p99 {p99:6.1f} ms", flush=True)


def monotonic_of(wall_ms: float) -> float:
    """A page's wall-clock time (ms) on the monotonic clock (s) of this machine."""
    return wall_ms / 1000 - (time.time() - time.monotonic())


def log_in(browser: Browser, battle: Battle, name: str) -> Page:
    page = browser.new_context(viewport={"width": 1280, "height": 800}).new_page()
    page.goto(battle.web)
    page.locator("#username").fill(name)
    page.locator("#username").press("Enter")
    page.wait_for_url("**/home")
    return page


def key_to_coil(page: Page, robot: TracedRobot, taps: Taps, priority: str) -> None:
    latencies, hops = [], Hops("page sends", "ROS topic", "serial line", "coil")
    for _ in range(PRESSES):
        robot.last_step()
        page.keyboard.down("ArrowUp")
        pressed = monotonic_of(page.evaluate("stopwatch.keys.at(-1)"))
        coil = robot.first_step_after(pressed)
        latencies.append(coil - pressed)
        sent = monotonic_of(page.evaluate("stopwatch.sent.find(at => at >= stopwatch.keys.at(-1))"))
        line = first_after(robot.line["uart-in"], sent)
        hops.add(pressed, sent, first_after(taps.commands, sent), line, coil)
        page.keyboard.up("ArrowUp")
    report(f"key press -> first coil change, {priority}", latencies, "p50 <= 5, p99 <= 20 ms")
    hops.report()


def release_to_still(page: Page, robot: TracedRobot) -> None:
    times = []
    for _ in range(CUTS):
        page.keyboard.down("ArrowUp")
        robot.first_step_after(time.monotonic())
        released = time.monotonic()
        page.keyboard.up("ArrowUp")
        times.append(max(0.0, robot.last_step() - released))
    report("key released -> wheels still", times, "350 ms")


def light_to_life(page: Page, shooter: Player, robot: TracedRobot, taps: Taps) -> None:
    """`page` is another player's: it shows the life of the one who is hit."""
    latencies, hops = [], Hops("line", "hit's topic", "status' topic", "socket", "page")
    to_socket, missed = [], 0
    time.sleep(SHOTS_APART)  # what is left of earlier measurements
    while not robot.dark.empty():
        robot.dark.get()
    for _ in range(HITS):
        shown = page.evaluate("stopwatch.lives.length")
        next_shot = time.monotonic() + SHOTS_APART
        shooter.drive(angular=1, shoot=True)
        robot.shine_packet(shooter.robot)
        ended = robot.packet_seen()
        # seldom: whoever asks a page keeps it from its work
        try:
            page.wait_for_function("shown => stopwatch.lives.length > shown", arg=shown, polling=100, timeout=5000)
        except PageTimeout:
            missed += 1
            continue
        seen = monotonic_of(page.evaluate(f"stopwatch.lives[{shown}]"))
        latencies.append(seen - ended)
        told = first_change(taps.told, "Driver", ended)
        to_socket.append(told - ended)
        status = first_change(taps.lives, "Driver", ended)
        hops.add(ended, first_after(robot.line["uart-out"], ended), first_after(taps.hits, ended), status, told, seen)
        time.sleep(max(0.0, next_shot - time.monotonic()))
    print(f"{missed} of {HITS} packets were no hit", flush=True)
    report("end of a packet -> status at a socket", to_socket, "p50 <= 8, p99 <= 20 ms")
    report("end of a packet -> life on another player's page", latencies, "p50 <= 16, p99 <= 50 ms")
    hops.report()


def stepper_speed(page: Page, robot: TracedRobot) -> None:
    """Half-steps per second of AVR time at full command, with 40 Hz commands and IR traffic."""
    robot.last_step()
    page.keyboard.down("ArrowUp")
    robot.first_step_after(time.monotonic())
    cycles: dict[str, list[int]] = {"left": [], "right": []}
    end = time.monotonic() + 3
    switch = True
    while time.monotonic() < end:
        robot.light(switch)
        switch = not switch
        with contextlib.suppress(queue.Empty):
            for _ in range(200):
                _, now, wheel = robot.steps.get(timeout=0.2)
                cycles[wheel].append(now)
    page.keyboard.up("ArrowUp")
    robot.light(False)
    for wheel, stamps in cycles.items():
        speed = (len(stamps) - 1) * AVR_HZ / (stamps[-1] - stamps[0])
        print(
            f"stepper speed, {wheel} wheel, {len(stamps)} half-steps: {speed:.1f} half-steps/s (budget 1024 +-1 %)",
            flush=True,
        )


def cut(what: str, page: Page, robot: TracedRobot, sever: Callable[..., object], mend: Callable[..., object]) -> None:
    """From the cut to the last half-step, while the key is held."""
    times = []
    for _ in range(CUTS):
        robot.last_step()
        page.keyboard.down("ArrowUp")
        robot.first_step_after(time.monotonic())
        moment = time.monotonic()
        sever()
        times.append(max(0.0, robot.last_step() - moment))
        mend()
        page.keyboard.up("ArrowUp")
    report(f"stream cut at {what} -> wheels still", times, "350 ms")


def priority_of(robot: TracedRobot) -> str:
    """Of robot 3's serial node, in words; the other programs have the same."""
    realtime = os.sched_getscheduler(robot.serial_node()) == os.SCHED_RR
    return "real-time priority" if realtime else "usual priority"


def measure(battle: Battle, browser: Browser, folder: Path, priority: str) -> None:
    """All of it with a priority, only key to coil without."""
    with contextlib.ExitStack() as stack:
        others = [stack.enter_context(Player(battle, f"Other{number}")) for number in range(3)]
        robot = TracedRobot(battle, folder, priority)
        stack.callback(robot.stop)
        until(lambda: others[0].post("getAvailableRobots")["availableR"] == 1, 20, "robot 3 is registered")
        taps = Taps(battle, ROBOT)
        stack.callback(taps.close)
        driver = log_in(browser, battle, "Driver")
        # a fifth page needs a robot to log in: the watcher takes over one of the others
        others.pop().__exit__()
        watcher = log_in(browser, battle, "Watcher")
        for page in (driver, watcher):
            page.evaluate(STOPWATCH)
            page.locator("#ready-btn").click()
        for player in others:
            player.ready()
        until(lambda: "PLAY!" in driver.locator("#game-status").inner_text(), 15, "the battle begins")
        driver.bring_to_front()
        with keep_turning(*others):  # they drive in circles
            key_to_coil(driver, robot, taps, priority_of(robot))
            if priority != "0":
                all_else(battle, driver, robot)
                light_to_life(watcher, others[0], robot, taps)


def all_else(battle: Battle, driver: Page, robot: TracedRobot) -> None:
    release_to_still(driver, robot)
    stepper_speed(driver, robot)
    rosbridge = battle.pid(r"python3 -m server\.rosbridge")
    for what, pid in (
        ("rosbridge (stands still)", rosbridge),
        ("the serial node (stands still)", robot.serial_node()),
    ):
        cut(
            what,
            driver,
            robot,
            lambda pid=pid: os.kill(pid, signal.SIGSTOP),
            lambda pid=pid: os.kill(pid, signal.SIGCONT),
        )


def main() -> None:
    for priority in ("1", "0"):
        bench(priority)


def bench(priority: str) -> None:
    rules = {"LASERBOT_HIT_DAMAGE": "1", "LASERBOT_COUNTDOWN": "1", "LASERBOT_BATTLE_LIMIT": "3600"}
    started = time.monotonic()
    with (
        tempfile.TemporaryDirectory(prefix="laserbot-bench-") as folder,
        Battle(3, 0, LASERBOT_PRIORITY=priority, **rules) as battle,
        sync_playwright() as playwright,
    ):
        print(f"ci/demo --robots 3: ready after {time.monotonic() - started:.1f} s", flush=True)
        browser = playwright.chromium.launch(executable_path=CHROMIUM, headless=True, args=FLAGS)
        try:
            measure(battle, browser, Path(folder), priority)
        finally:
            browser.close()


if __name__ == "__main__":
    main()
