"""Uses rosbridge with roslibpy: python -m tests.integration.rosbridge.roslibpy_client PORT. Prints {name: value}."""

import json
import sys
import threading
from typing import Any

import roslibpy


def main() -> None:
    ros = roslibpy.Ros("127.0.0.1", int(sys.argv[1]))
    ros.run()
    tell("guest watches", hear(ros, "/game_status", "laser_bot_battle/GameStatus")["game"])
    ros.send_on_ready(roslibpy.Message({"op": "auth", "client": "operator", "mac": "the operators' token"}))
    service = roslibpy.Service(ros, "/add_new_robot", "laser_bot_battle/AddNewRobot")
    tell("operator calls", dict(service.call(roslibpy.ServiceRequest(), timeout=5)))
    chat = roslibpy.Topic(ros, "/roslibpy_chat", "std_msgs/UInt8MultiArray", latch=True)
    chat.publish(roslibpy.Message({"data": [1, 2, 255]}))
    tell("operator hears", hear(ros, "/roslibpy_chat", "std_msgs/UInt8MultiArray")["data"])
    chat.unadvertise()
    stamped = roslibpy.Topic(ros, "/roslibpy_header", "std_msgs/Header", latch=True)
    stamped.publish(roslibpy.Message(dict(roslibpy.Header(seq=0, stamp=roslibpy.Time(5, 6), frame_id="arena"))))
    tell("header", hear(ros, "/roslibpy_header", "std_msgs/Header")["stamp"])
    ros.terminate()


def hear(ros: roslibpy.Ros, name: str, kind: str) -> dict[str, Any]:
    heard: list[dict[str, Any]] = []
    came = threading.Event()

    def hear_one(message: dict[str, Any]) -> None:
        heard.append(message)
        came.set()

    topic = roslibpy.Topic(ros, name, kind, throttle_rate=1, queue_length=1)
    topic.subscribe(hear_one)
    assert came.wait(5), name
    topic.unsubscribe()
    return heard[0]


def tell(name: str, value: Any) -> None:
    print(json.dumps({name: value}), flush=True)


if __name__ == "__main__":
    main()
