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

enum {
	EMITTER_EDGES = 64,      /* far more than a transmitter makes in a slice */
	PACKET_DARKNESS = 48000, /* cycles (3 ms) without an edge: longer than any mark or space of a packet */
};

/* The carrier starts or ends at `cycle`; or, if nothing has changed, is still on or off then. */
struct carrier_edge {
	uint64_t cycle;
	bool on;
};

struct emitter {
	struct avr_t *avr;
	struct trace *trace;
	bool output, level; /* PD3's bits of DDRD and PORTD */
	bool plain, carrier; /* how it shines; never both */
	uint64_t last_edge;
	bool in_packet;
	struct carrier_edge edges[EMITTER_EDGES];
	size_t edges_length;
};

void emitter_init(struct emitter *emitter, struct avr_t *avr, struct trace *trace);

/* After each reset of the AVR, whose registers are clear then. */
void emitter_reset(struct emitter *emitter);

/* PORTD and DDRD are now `level` and `output`. */
void emitter_drive(struct emitter *emitter, uint8_t level, uint8_t output);

/* Within a packet, add to `edges` how it is now, so that who sees it knows that no edge has been missed. */
void emitter_confirm(struct emitter *emitter);

/* Forget `edges` after passing them on. */
void emitter_clear_edges(struct emitter *emitter);

#endif
