/*
 * The robot's physical contact with the arena: wheels, beam and carrier out, light in; ASCII lines over TCP, which
 * sim/arena/protocol.py lists.
 *
 * A thread of its own does all that can wait (name lookup, connecting, a slow arena), so that the AVR never does. It
 * reconnects for ever, four times a second; without an arena it is dark.
 */
#ifndef AVR_ROBOT_ARENA_LINK_H
#define AVR_ROBOT_ARENA_LINK_H

#include "emitter.h"
#include "options.h"

#include <stdbool.h>
#include <stdint.h>

struct arena_link;

/* Start connecting; NULL with a line on stderr if there are no threads. Lives until the process ends. */
struct arena_link *arena_link_start(const struct address *arena, const char *robot);

/* The robot's state now; the thread sends what has changed: a beam at once, wheels at most every 10 ms. */
void arena_link_publish(struct arena_link *link, int64_t left, int64_t right, bool beam);

/* Send edges of the carrier at once; they are lost when there is no arena, as light is. */
void arena_link_send_edges(struct arena_link *link, const struct carrier_edge *edges, size_t length);

enum light_kind { LIGHT_DARK, LIGHT_PLAIN, LIGHT_LAMP, LIGHT_CARRIER };

/* What the arena says of the light on the receiver. */
struct light_event {
	enum light_kind kind; /* LIGHT_DARK: the arena has gone, and all light with it */
	bool on;
	unsigned source; /* of a carrier, */
	uint64_t cycle;  /* and when in its own time */
};

/* A descriptor that is readable when events have come since arena_link_await_light(). */
int arena_link_descriptor(const struct arena_link *link);

/* What has come so far is no news any more. */
void arena_link_await_light(struct arena_link *link);

/* The next event, in the order in which the arena reported them; false if there is none. */
bool arena_link_take_light(struct arena_link *link, struct light_event *event);

#endif
