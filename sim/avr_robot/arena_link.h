/*
 * The robot's physical contact with the arena: wheels and beam out, light in; ASCII lines over TCP.
 *
 * A thread of its own does all that can wait (name lookup, connecting, a slow arena), so that the AVR never does. It
 * reconnects every second for ever; without an arena it is dark.
 */
#ifndef AVR_ROBOT_ARENA_LINK_H
#define AVR_ROBOT_ARENA_LINK_H

#include "options.h"

#include <stdbool.h>
#include <stdint.h>

struct arena_link;

/* Start connecting; NULL with a line on stderr if there are no threads. Lives until the process ends. */
struct arena_link *arena_link_start(const struct address *arena, const char *robot);

/* The robot's state now; the thread sends what has changed: a beam at once, wheels at most every 10 ms. */
void arena_link_publish(struct arena_link *link, int64_t left, int64_t right, bool beam);

/* The next change of the light on the sensor, in the order in which the arena reported it; false if there is none. */
bool arena_link_take_light(struct arena_link *link, bool *light);

#endif
