"""Which release a host goes back to (roles registry and release): the one before, also if it was off when that came."""

import base64
import json
from pathlib import Path

import pytest
import yaml

from tests.support.local_play import play_role, recap

REGISTRY = "laser-bot-master.local:5443"


def noted(release: str) -> dict[str, object]:
    """As the master notes a release."""
    return {"release": release, "images": [f"rosberry@sha256:r{release}", f"webserver@sha256:w{release}"]}


def robots_image(release: str) -> str:
    return f"{REGISTRY}/rosberry@sha256:r{release}"


def releases_after_a_newest(folder: Path, runs: str) -> object:
    """What the master notes when release 3 comes after 1 and 2, while it runs this one."""
    (folder / "releases.json").write_text(json.dumps({"newest": noted("2"), "before": noted("1")}))
    (folder / "release.json").write_text(json.dumps({"release": runs}))
    images = {"webserver": {"digest": "sha256:w3"}, "rosberry": {"digest": "sha256:r3"}}
    variables = yaml.safe_dump({"fleet_folder": str(folder), "fleet_release": "3", "fleet_images": images})
    run = play_role("registry", "releases", variables, folder, "laser_bot_master")
    assert recap(run.stdout)["laser_bot_master"]["changed"] == 1, run.stdout
    return json.loads((folder / "releases.json").read_text())


@pytest.mark.slow
def test_the_release_before_is_the_one_that_the_master_ran(tmp_path: Path) -> None:
    assert releases_after_a_newest(tmp_path, runs="2") == {"newest": noted("3"), "before": noted("2")}
    assert releases_after_a_newest(tmp_path, runs="1") == {"newest": noted("3"), "before": noted("1")}, "it went back"


def remembered(folder: Path, **before: dict[str, str]) -> dict[str, object]:
    """What hosts with these notes remember when they have got the robot's image of release 3, after 2."""
    content = base64.b64encode(json.dumps({"newest": noted("3"), "before": noted("2")}).encode()).decode()
    variables = {
        "fleet_folder": f"{folder}/{{{{ inventory_hostname }}}}",
        "fleet_release": "3",
        "release_role": "robot",
        "release_image": robots_image("3"),
        "release_noted": {"content": content},
        "notes": {host: json.dumps(known) if known else "" for host, known in before.items()},
        "release_remembered": {"stdout": "{{ notes[inventory_hostname] }}"},
    }
    for host in before:
        (folder / host).mkdir(exist_ok=True)
    run = play_role("release", "remember", yaml.safe_dump(variables), folder, ",".join(before))
    assert [row["changed"] for row in recap(run.stdout).values()] == [1] * len(before), run.stdout
    return {host: json.loads((folder / host / "release.json").read_text()) for host in before}


def test_a_robot_goes_back_by_one_release(tmp_path: Path) -> None:
    def having(release: str, offered: str) -> dict[str, str]:
        return {"current": robots_image(release), "previous": "", "release": release, "offered": offered}

    known = {
        "laser_bot_master": having("2", offered="2"),
        "raspberrypi1": having("1", offered="1"),  # it was off when 2 came
        "raspberrypi2": having("1", offered="2"),  # it has refused 2, or has gone back
    }
    now = having("3", offered="3")
    assert remembered(tmp_path, **known) == {
        "laser_bot_master": now | {"previous": robots_image("2")},
        "raspberrypi1": now | {"previous": robots_image("2")},
        "raspberrypi2": now | {"previous": robots_image("1")},
    }


def test_a_new_robot_has_nothing_to_go_back_to(tmp_path: Path) -> None:
    now = {"current": robots_image("3"), "previous": "", "release": "3", "offered": "3"}
    assert remembered(tmp_path, raspberrypi1={}) == {"raspberrypi1": now}
