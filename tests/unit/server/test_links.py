"""Who is on which topics, from the ROS master's lists."""

import pytest

from server.ros.presence import drivers


@pytest.mark.parametrize(
    ("publishers", "subscribers", "expected"),
    [
        ([["/Robot1/response", ["/Robot1"]]], [["/Robot1/command", ["/Robot1"]]], {1: {"/Robot1"}}),
        (
            [["/Robot1/response", ["/x", "/Robot1"]]],
            [["/Robot1/command", ["/rosbridge_websocket", "/Robot1"]]],
            {1: {"/Robot1"}},
        ),
        ([["/Robot1/response", ["/Robot1"]]], [["/Robot1/command", ["/rosbridge_websocket"]]], {}),
        ([["/Robot1/response", ["/Robot1"]]], [["/Robot2/command", ["/Robot1"]]], {}),
        ([], [["/Robot1/command", ["/Robot1"]]], {}),
        ([["/Robot3/response", ["/Robot3"]]], [["/Robot3/command", ["/Robot3"]]], {}),
        ([], [], {}),
    ],
)
def test_a_robot_is_linked_when_one_node_is_on_both_topics(publishers, subscribers, expected) -> None:
    assert drivers((0, 1, 2), publishers, subscribers) == expected
