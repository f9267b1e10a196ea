/*
 * The infrared emitter on PD3 = pin 3, on while its pin is low: plain light when the pin is driven low, and a carrier of
 * 38 kHz while timer 2 drives it (OC2B). The carrier is known from the timer's registers; its single pulses are not.
 */
#ifndef AVR_ROBOT_EMITTER_H
#define AVR_ROBOT_EMITTER_H

#include "trace.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct avr_t;

enum { EMITTER_EDGES = 64 }; /* far more than a transmitter for people's eyes and ears makes in a slice */

/* The carrier starts or ends. */
struct carrier_edge {
	uint64_t cycle;
	bool on;
};

struct emitter {
	struct avr_t *avr;
	struct trace *trace;
	bool output, level; /* PD3's bits of DDRD and PORTD */
	bool plain, carrier; /* how it shines; never both */
	struct carrier_edge edges[EMITTER_EDGES];
	size_t edges_length;
};

void emitter_init(struct emitter *emitter, struct avr_t *avr, struct trace *trace);

/* After each reset of the AVR, whose registers are clear then. */
void emitter_reset(struct emitter *emitter);

/* PORTD and DDRD are now `level` and `output`. */
void emitter_drive(struct emitter *emitter, uint8_t level, uint8_t output);

/* Forget `edges` after passing them on. */
void emitter_clear_edges(struct emitter *emitter);

#endif
