"""The floors that tests play on."""

from laser_bot_battle.floor import read_floor

BATTLE_FLOOR = read_floor("battle")
DUEL_FLOOR = read_floor("duel")
