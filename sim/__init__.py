"""Virtual hardware: the AVR robot (C on simavr) and the arena in which robots meet; a bot that plays; and the demo."""
