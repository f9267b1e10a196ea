/*
 * What sees light: the receiver on PD2 = pin 2 (INT0), which pulls its pin low.
 *
 * A bare phototransistor sees every light, a carrier as long as it lasts. A demodulating receiver (TSOP48xx) sees nothing
 * but carriers of 38 kHz, and what it puts out lasts a little longer than what it sees.
 *
 * Carriers come from sources with clocks of their own. The first edge after a pause is seen LIGHT_DELAY later, so that
 * slow networks do no harm; the following ones as much later as they were in the source's time. Within a packet, the AVR
 * must not run ahead of what is known of its source.
 */
#ifndef AVR_ROBOT_RECEIVER_H
#define AVR_ROBOT_RECEIVER_H

#include "trace.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct avr_t;
struct avr_irq_t;
struct avr_int_vector_t;

enum {
	LIGHT_SOURCES = 16, /* that the arena can have */
	SOURCE_EDGES = 80,  /* of one source that wait to be seen: a frame of a remote control has 68 */
	SEEN_EDGES = LIGHT_SOURCES * SOURCE_EDGES,
};

/* An edge that is still to be seen. */
struct seen_edge {
	uint64_t due; /* cycle */
	unsigned source;
	bool on;
};

struct light_source {
	uint64_t edge;   /* the newest one: cycles in the source's time */
	uint64_t known;  /* and until when it is known that no other has followed */
	uint64_t shift;  /* from its time to ours, modulo 2^64 */
	uint64_t ready;  /* cycle at which its newest edge is seen */
	size_t waiting;  /* edges that are still to be seen */
	bool heard;      /* there is a newest edge */
	bool told;       /* whether it was a start */
	bool on;         /* as it is seen */
	uint64_t on_since; /* cycle */
};

struct receiver {
	struct avr_t *avr;
	struct trace *trace;
	struct avr_irq_t *pin;
	struct avr_int_vector_t *interrupt; /* INT0 */
	bool demodulates;
	bool plain, lamp, lamp_phase;
	uint64_t lamp_due; /* cycle of its next change */
	struct light_source sources[LIGHT_SOURCES];
	struct seen_edge edges[SEEN_EDGES]; /* the next one is the last */
	size_t edges_length;
	bool light; /* pulls its pin low */
};

void receiver_init(struct receiver *receiver, struct avr_t *avr, bool demodulates, struct trace *trace);

/* After each reset of the AVR. */
void receiver_reset(struct receiver *receiver);

/* Call often: simavr's faults are mended, and marks that nobody ends are ended. */
void receiver_keep_going(struct receiver *receiver);

/* Plain light is there from now on, or not. */
void receiver_shine(struct receiver *receiver, bool light);

/* A lamp is there from now on: plain light that comes and goes with the mains, 100 times a second. */
void receiver_light_lamp(struct receiver *receiver);

/* The carrier of `source` < LIGHT_SOURCES starts or ends at `cycle` of its own time, or is still on or off then. */
void receiver_carrier(struct receiver *receiver, unsigned source, uint64_t cycle, bool on);

/* Whether the AVR has to wait for news of a source before it may run until `cycle`. */
bool receiver_has_to_wait(const struct receiver *receiver, uint64_t cycle);

/* Do not wait any longer: what comes late is seen late. */
void receiver_give_up(struct receiver *receiver);

/* There is no light at all any more. */
void receiver_darken(struct receiver *receiver);

#endif
