/*
 * The Uno's UART line: bytes on their way to the AVR, one per byte time, and the bytes that the AVR has sent.
 *
 * simavr's own receiver has 64 bytes and takes them at any speed. A real ATmega328P has two bytes and a shift register;
 * what it would have lost is lost here too, and counted.
 */
#ifndef AVR_ROBOT_UART_H
#define AVR_ROBOT_UART_H

#include "trace.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct avr_t;
struct avr_uart_t;
struct avr_irq_t;

enum {
	UART_QUEUE_BYTES = 64, /* as many as the Uno's USB converter holds; the rest waits in the host's kernel */
	UART_SENT_BYTES = 256, /* far more than the line carries in a slice */
};

struct uart {
	struct avr_t *avr;
	struct avr_uart_t *port;
	struct avr_irq_t *input;
	struct trace *trace;
	uint8_t queue[UART_QUEUE_BYTES]; /* ring */
	size_t queue_start, queue_length;
	bool line_busy;                  /* the timer for the end of the byte on the line is running */
	uint64_t dropped;                /* bytes that the receiver has lost */
	uint8_t sent[UART_SENT_BYTES];
	size_t sent_length;
};

/* Attach to UART0; false if this AVR has none. */
bool uart_init(struct uart *uart, struct avr_t *avr, struct trace *trace);

/* How many bytes uart_receive() will take now. */
size_t uart_room(const struct uart *uart);

/* Queue `length` <= uart_room() bytes for the AVR. */
void uart_receive(struct uart *uart, const uint8_t *bytes, size_t length);

/* Forget what is on its way to the AVR. */
void uart_reset(struct uart *uart);

/* An AVR reset forgets simavr's timers: call regularly to restart a line that got stuck so. */
void uart_keep_going(struct uart *uart);

/* Forget `sent` after passing it on. */
void uart_clear_sent(struct uart *uart);

#endif
