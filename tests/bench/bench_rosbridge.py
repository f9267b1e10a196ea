"""What rosbridge costs: `python3 -m tests.bench.bench_rosbridge` prints CPU time and latency per message.

Budgets: 47 to 72 us of CPU per publish, 39 to 58 us per delivery, half of upstream's rosbridge.
CPU time is measured in bursts. At the pace of players, waking up for each message comes on top, which on a virtual
machine can be several times as much: an empty websockets server that only receives pays it as well.
"""

import json
import os
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager

import rospy
from websockets.sync.client import ClientConnection, connect

from laser_bot_battle.msg import Robot_msg
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import Program

MESSAGES = 10000
PACE = 160  # messages/s, four players holding a key
LOAD = 3000  # messages/s
BURST = 20  # messages
TYPE = Robot_msg._type
COMMAND = {"linear_x": 1, "angular_z": -1, "shoot": False}


def main() -> None:
    """Both directions, in bursts and at the pace of players."""
    with rosbridge() as (url, pid):
        publish(url, pid)
        for clients in (1, 4):
            deliver(url, pid, clients)


@contextmanager
def rosbridge() -> Iterator[tuple[str, int]]:
    """A ROS master and rosbridge; yields the WebSocket address and rosbridge's process ID."""
    master_port, port = free_port(), free_port()
    environment = {
        "ROS_MASTER_URI": f"http://127.0.0.1:{master_port}",
        "ROS_IP": "127.0.0.1",
        "LASERBOT_ROSBRIDGE_PORT": str(port),
        "LASERBOT_OPERATOR_TOKEN": "bench",
    }
    os.environ.update(environment)
    master = Program(["rosmaster", "--core", "-p", str(master_port)])
    bridge = Program.python("server.rosbridge")
    try:
        bridge.wait_for("listening")
        rospy.init_node("bench", disable_signals=True)
        yield f"ws://127.0.0.1:{port}", bridge.process.pid
        rospy.signal_shutdown("done")
        print(bridge.output if "WARN" in bridge.output else "", end="")
    finally:
        bridge.stop()
        master.stop()


def publish(url: str, pid: int) -> None:
    """From a WebSocket to a ROS subscriber."""
    arrived: list[float] = []
    subscriber = rospy.Subscriber(
        "/Robot0/command", Robot_msg, lambda _: arrived.append(time.perf_counter()), tcp_nodelay=True
    )
    with operator(url) as socket:
        socket.send(json.dumps({"op": "advertise", "topic": "/Robot0/command", "type": TYPE}))
        until(subscriber.get_num_connections, what="a connection from rosbridge")
        text = json.dumps({"op": "publish", "id": "publish:2", "topic": "/Robot0/command", "msg": COMMAND})
        start = cpu_seconds(pid)
        for _ in paced(LOAD / BURST, MESSAGES // BURST):
            for _ in range(BURST):
                socket.send(text)
        until(lambda: time.perf_counter() - arrived[-1] > 0.5, what="the end of the load")
        used = cpu_seconds(pid) - start
        arrived.clear()
        sent: list[float] = []
        for _ in paced(PACE, 4 * PACE):
            sent.append(time.perf_counter())
            socket.send(text)
        until(lambda: len(arrived) == len(sent), what="all messages")
        subscriber.unregister()  # before the socket closes, which stops the robot by one more command
    show("publish", used / MESSAGES, [there - here for here, there in zip(sent, arrived, strict=True)])


def deliver(url: str, pid: int, clients: int) -> None:
    """From a ROS publisher to WebSockets; a message counts once for each."""
    topic = f"/bench{clients}"
    publisher = rospy.Publisher(topic, Robot_msg, queue_size=MESSAGES)
    sockets = [operator(url) for _ in range(clients)]
    for socket in sockets:
        socket.send(json.dumps({"op": "subscribe", "topic": topic, "type": TYPE, "queue_length": 1000}))
    until(publisher.get_num_connections, what="rosbridge's subscription")
    start = cpu_seconds(pid)
    for _ in paced(LOAD / BURST, MESSAGES // BURST):
        for _ in range(BURST):
            publisher.publish(1, -1, False)
    for socket in sockets:
        for _ in range(MESSAGES):
            socket.recv(timeout=5)
    used = cpu_seconds(pid) - start
    latencies = []
    for _ in paced(PACE, 4 * PACE):
        sent = time.perf_counter()
        publisher.publish(1, -1, False)
        for socket in sockets:
            socket.recv(timeout=1)
            latencies.append(time.perf_counter() - sent)
    for socket in sockets:
        socket.close()
    publisher.unregister()
    show(f"delivery to {clients}", used / MESSAGES / clients, latencies)


def operator(url: str) -> ClientConnection:
    socket = connect(url, max_queue=None)
    socket.send(json.dumps({"op": "auth", "client": "operator", "mac": "bench"}))
    return socket


def paced(rate: float, messages: int) -> Iterator[None]:
    start = time.perf_counter()
    for number in range(messages):
        time.sleep(max(0.0, start + number / rate - time.perf_counter()))
        yield


def show(what: str, cpu: float, latencies: list[float]) -> None:
    p50, p99 = statistics.median(latencies) * 1e3, statistics.quantiles(latencies, n=100)[98] * 1e3
    print(f"{what:13} {cpu * 1e6:3.0f} us CPU a message; at {PACE}/s p50 {p50:.2f} ms, p99 {p99:.2f} ms")


def cpu_seconds(pid: int) -> float:
    """CPU time of another process and all its threads, in s (clock_getcpuclockid(3))."""
    return time.clock_gettime((~pid << 3) | 2)


if __name__ == "__main__":
    main()
