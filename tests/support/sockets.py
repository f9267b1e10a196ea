"""The WebSocket clients of the tests."""

from functools import partial

from websockets.sync import client

# No keepalive: in websockets 15 its thread adds a ping while the reading thread goes through the pings of a
# connection that ends, which fails by chance once a test lasts longer than the 20 s between two pings. The servers'
# own pings find the dead.
connect = partial(client.connect, ping_interval=None)  # noqa: TID251

# For a connection that nobody reads: once its queue is full, the client does not get the server's farewell, and would
# wait 10 s for it.
connect_unread = partial(connect, close_timeout=0)
