/*
 * The event trace on stdout: `<monotonic_ns> <avr_cycles> <event...>`, one line per event.
 *
 *   ready                       the UART is open, the AVR starts
 *   reset opened|watchdog       the AVR starts again: another program has opened the UART, or its watchdog has fired
 *   coil left|right POSITION    a half-step; cumulative, signed
 *   slip left|right             a change of the coils that the motor cannot follow
 *   coils left|right on|off     the motor gets current where it stands; it gets none any more
 *   beam 0|1                    plain light of the infrared emitter
 *   carrier 0|1                 its carrier
 *   light 0|1                   what the receiver sees
 *   late N                      an edge of a carrier came N cycles too late to be seen in time
 *   uart-in N, uart-out N       bytes that came from the host and go on the line now; that went to the host
 *   uart-drop N                 a byte came faster than the AVR read; N = lost ones since power-on
 *   tick                        every 10 ms: so far the AVR has come
 */
#ifndef AVR_ROBOT_TRACE_H
#define AVR_ROBOT_TRACE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct trace {
	FILE *out; /* NULL: no trace */
	bool dirty;
};

/* Append one event, worded by a printf format. Lines become visible at the next trace_flush(). */
__attribute__((format(printf, 3, 4))) void trace_event(struct trace *trace, uint64_t cycles, const char *format, ...);

void trace_flush(struct trace *trace);

#endif
