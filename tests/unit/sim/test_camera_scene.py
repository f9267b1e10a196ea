"""What the arena tells the process that paints."""

import io

import pytest

from laser_bot_battle.geometry import Pose
from sim.arena.ambient import Ambient
from sim.arena.cameras.scene import Body, Room, Scene, frame_of, read_frame
from sim.arena.cameras.streams import scene_of
from sim.arena.world import World
from tests.support.floors import BATTLE_FLOOR


def test_a_room_arrives_as_it_was_sent() -> None:
    room = Room(1.6, 1.2, BATTLE_FLOOR.walls, Ambient(sun=True), timecode=True)
    assert Room.decode(room.encode()) == room


def test_a_scene_arrives_as_it_was_sent() -> None:
    scene = Scene("virtual1", 12.5, 1.7e9, (Body("virtual1", 1, 0.1, 0.2, 3.0), Body("guest", None, 1, 1, 0, True)))
    assert Scene.decode(scene.encode()) == scene


def test_frames_follow_each_other() -> None:
    stream = io.BytesIO(frame_of(b"one") + frame_of(b"") + frame_of(b"three"))
    assert [read_frame(stream) for _ in range(4)] == [b"one", b"", b"three", None]


def test_half_a_frame_is_the_end() -> None:
    assert read_frame(io.BytesIO(frame_of(b"three")[:-1])) is None


def test_a_scene_has_everybody_and_how_far_their_light_goes() -> None:
    world = World(BATTLE_FLOOR)
    world.arrive("virtual0").pose = Pose(0.3, 0.15, 0)
    world.arrive("virtual1").pose = Pose(0.7, 0.15, 0)
    world.set_beam("virtual0", True)
    world.update_light()
    shooter, target = scene_of(world, "virtual1", now=5.0, taken=1.7e9).robots
    assert (shooter.id, shooter.x, shooter.beam, shooter.lit) == (0, 0.3, True, False)
    assert shooter.reach == pytest.approx(0.7 - 0.075 - 0.36)
    assert (target.id, target.beam, target.lit, target.reach) == (1, False, True, 0.0)
