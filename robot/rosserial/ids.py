"""Topic ids of the rosserial protocol itself."""

from robot.rosserial.frame import encode

PUBLISHER = 0  # device -> host: TopicInfo; host -> device, empty: tell me your topics
SUBSCRIBER = 1
SERVED_ANSWERS = 2  # of a service that the device offers
SERVED_REQUESTS = 3
CALLED_REQUESTS = 4  # of a service that the device calls
CALLED_ANSWERS = 5
PARAMETER = 6
LOG = 7
TIME = 10
TX_STOP = 11
FIRST_TOPIC = 100  # ids of messages

TOPIC_REQUEST = encode(PUBLISHER)
STOP_SENDING = encode(TX_STOP)
