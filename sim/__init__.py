"""Virtual hardware: the AVR robot (C on simavr) and the arena in which robots meet; and the demo."""
