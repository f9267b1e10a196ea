"""`python3 -m sim.arena.cameras`: paints what robots see. The arena starts it; frames come by stdin, go by stdout."""

from sim.arena.cameras.painting import paint
from sim.arena.cameras.picture import Painter
from sim.arena.cameras.scene import Room

if __name__ == "__main__":
    paint(lambda room: Painter(Room.decode(room)).jpeg)
