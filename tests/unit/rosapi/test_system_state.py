"""What the master's answer means."""

from server.rosapi.system_state import SystemState, action_servers, used_by

STATE = SystemState.of(
    [
        [["/chat", ["/bo", "/al"]], ["/scan", ["/al"]]],
        [["/chat", ["/al"]], ["/orders", ["/cy"]]],
        [["/al/stop", ["/al"]]],
    ]
)


def test_topics_and_nodes_are_all_that_somebody_uses() -> None:
    assert STATE.topics() == ["/chat", "/orders", "/scan"]
    assert STATE.nodes() == ["/al", "/bo", "/cy"]


def test_a_node_is_what_it_uses() -> None:
    parts = [used_by("/al", part) for part in STATE]
    assert parts == [["/chat", "/scan"], ["/chat"], ["/al/stop"]]
    assert [used_by("/nobody", part) for part in STATE] == [[], [], []]


def test_an_action_server_has_all_five_topics() -> None:
    parts = ("goal", "cancel", "status", "feedback", "result")
    topics = [f"/arm/move/{part}" for part in parts] + ["/arm/move/zoom", "/arm/goal", *(f"/{part}" for part in parts)]
    assert action_servers(topics) == ["/arm/move"]
    assert action_servers(set(topics) - {"/arm/move/result"}) == []
