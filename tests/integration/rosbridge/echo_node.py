"""A ROS node that says on /answer what it hears on /question, at once. Prints "ready"."""

import asyncio
import os

from std_msgs.msg import String

from tcpros.node import Node
from tcpros.specs import TypeSpec

STRING = TypeSpec.of(String)


async def main() -> None:
    node = Node("echo", os.environ["ROS_MASTER_URI"])
    await node.start()
    # latest: nothing is kept for those who connect later
    answers = node.advertise("/answer", STRING, latest=True)
    questions = node.subscribe("/question", STRING, lambda data, _: answers.publish(data))
    await questions.settled()
    print("ready", flush=True)
    await asyncio.Event().wait()


if __name__ == "__main__":
    asyncio.run(main())
