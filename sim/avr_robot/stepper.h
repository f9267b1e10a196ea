/*
 * What a 4-phase stepper makes of its coil pattern.
 *
 * A pattern has one bit per coil, bit 0 = IN1 ... bit 3 = IN4 (Uno pins 8..11 left, 4..7 right). Half-stepping in the
 * positive direction runs through the eight phases 1, 1+2, 2, 2+3, 3, 3+4, 4, 4+1. Neighbouring phases turn the rotor by
 * one half-step; it cannot follow any other change, which is a slip: the step is lost.
 */
#ifndef AVR_ROBOT_STEPPER_H
#define AVR_ROBOT_STEPPER_H

#include <stdint.h>

enum stepper_event {
	STEPPER_STILL,     /* nothing changed */
	STEPPER_STEP,      /* one half-step; `position` has changed by +1 or -1 */
	STEPPER_SLIP,      /* a change that the rotor cannot follow; `position` stays */
	STEPPER_ENERGISED, /* current after none, in the phase where the rotor stands */
	STEPPER_RELEASED,  /* no coil has current any more */
};

struct stepper {
	int64_t position; /* half-steps since power-on, signed */
	int phase;        /* 0..7 where the rotor stands, 0 at power-on; -1 = nobody knows after a senseless pattern */
	uint8_t pattern;  /* coils with current now */
};

void stepper_init(struct stepper *stepper);

/* The coils' current changes to the low four bits of `pattern`. */
enum stepper_event stepper_update(struct stepper *stepper, uint8_t pattern);

#endif
