"""The robots' light, as far as the master's programs must know it (docs/protocol-light.md)."""

COOLDOWN = 0.5  # s from the start of one shot to the next, at least
PLAIN_PERIOD = 0.55  # s, likewise of plain light: a pulse, then the darkness by which it ends

# what MilesTag II's codes 0 to 15 take
DAMAGES = (1, 2, 4, 5, 7, 10, 15, 17, 20, 25, 30, 35, 40, 50, 75, 100)
