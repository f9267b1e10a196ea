#include "stepper.h"

enum { PHASES = 8, NO_PHASE = -1 };

static int phase_of(uint8_t pattern)
{
	static const uint8_t patterns[PHASES] = {0x1, 0x3, 0x2, 0x6, 0x4, 0xc, 0x8, 0x9};

	for (int phase = 0; phase < PHASES; phase++)
		if (patterns[phase] == pattern)
			return phase;
	return NO_PHASE;
}

void stepper_init(struct stepper *stepper)
{
	*stepper = (struct stepper){0};
}

enum stepper_event stepper_update(struct stepper *stepper, uint8_t pattern)
{
	pattern &= 0x0f;
	if (pattern == stepper->pattern)
		return STEPPER_STILL;

	const int was_released = stepper->pattern == 0;
	stepper->pattern = pattern;
	if (pattern == 0)
		return STEPPER_RELEASED;

	const int from = stepper->phase;
	const int to = phase_of(pattern);
	stepper->phase = to;
	if (to == NO_PHASE)
		return STEPPER_SLIP;
	if (from == NO_PHASE || from == to)
		return was_released ? STEPPER_ENERGISED : STEPPER_SLIP;
	switch ((to - from + PHASES) % PHASES) {
	case 1: stepper->position++; return STEPPER_STEP;
	case PHASES - 1: stepper->position--; return STEPPER_STEP;
	default: return STEPPER_SLIP;
	}
}
