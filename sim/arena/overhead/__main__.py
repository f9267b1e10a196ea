"""`python3 -m sim.arena.overhead`: paints the floor from above. The arena starts it."""

import sys

from laser_bot_battle.settings import SettingsError
from sim.arena.cameras.painting import paint
from sim.arena.overhead.picture import Painter
from sim.arena.overhead.room import Room

if __name__ == "__main__":
    try:
        paint(lambda room: Painter(Room.decode(room)).jpeg)
    except SettingsError as error:
        print(f"arena: {error}", file=sys.stderr)
        sys.exit(2)
