"""The rules of place, from /positions and the floor's file to /game_status."""

import json


def test_who_is_seen_alone_on_a_hill_of_the_floors_file_gets_points(launch, tmp_path):
    file = tmp_path / "hall.json"
    hill = {"name": "corner", "kind": "hill", "x": 1.9, "y": 0.9, "radius": 0.1}
    file.write_text(json.dumps({"width": 2, "height": 1, "starts": [[1, 0.5]], "zones": [hill]}))
    server = launch(LASERBOT_COUNTDOWN="0.5", LASERBOT_HILL="1", LASERBOT_FLOOR=str(file))
    server.wait_until_serving()
    server.peer("positions")  # of robot 1 there, and of robot 0 elsewhere
    players = {}
    for number, name in enumerate(("ada", "bob")):
        server.robot(f"robot{number}")
        players[name] = server.player(name)
    for player in players.values():
        player.ready()
    status = server.listener().wait_for(lambda status: any(user["points"] > 1 for user in status["users"]))
    assert [(user["name"], user["points"] > 1) for user in status["users"]] == [("bob", True), ("ada", False)]
    assert [(place["kind"], round(place["x"], 2), round(place["radius"], 2)) for place in status["places"]] == [
        (0, 1.9, 0.1)
    ]
