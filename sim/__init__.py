"""Virtual hardware: the AVR robot (C on simavr) and the arena in which virtual robots meet; and a bot that plays."""
