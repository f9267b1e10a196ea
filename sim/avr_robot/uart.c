#include "uart.h"

#include <inttypes.h>
#include <string.h>

#include <simavr/sim_avr.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_io.h>

#include <simavr/avr_uart.h>

DEFINE_FIFO(uint16_t, uart_fifo);

enum {
	BITS_PER_BYTE = 10,  /* start, eight data, stop */
	RECEIVER_BYTES = 3,  /* two in the FIFO, one in the shift register */
};

static avr_uart_t *find_port(avr_t *avr)
{
	for (avr_io_t *io = avr->io_port; io; io = io->next)
		if (strcmp(io->kind, "uart") == 0 && ((avr_uart_t *)io)->name == '0')
			return (avr_uart_t *)io;
	return NULL;
}

/* Cycles per byte as the registers say now. simavr reckons 11 bits, and only when UBRR0L is written. */
static avr_cycle_count_t set_byte_time(struct uart *uart)
{
	avr_uart_t *port = uart->port;
	const avr_cycle_count_t divisor =
		1 + (avr_regbit_get(uart->avr, port->ubrrl) | ((avr_cycle_count_t)avr_regbit_get(uart->avr, port->ubrrh) << 8));
	const avr_cycle_count_t samples = avr_regbit_get(uart->avr, port->u2x) ? 8 : 16;

	port->cycles_per_byte = BITS_PER_BYTE * divisor * samples;
	return port->cycles_per_byte;
}

static void drop(struct uart *uart)
{
	uart->dropped++;
	trace_event(uart->trace, uart->avr->cycle, "uart-drop %" PRIu64, uart->dropped);
}

/* The start bit of the next byte appears on the line; simavr itself waits one byte time before the AVR can read it. */
static void start_byte(struct uart *uart)
{
	const uint8_t byte = uart->queue[uart->queue_start];

	uart->queue_start = (uart->queue_start + 1) % UART_QUEUE_BYTES;
	uart->queue_length--;
	if (!avr_regbit_get(uart->avr, uart->port->rxen) || uart_fifo_get_read_size(&uart->port->input) >= RECEIVER_BYTES)
		drop(uart);
	else
		avr_raise_irq(uart->input, byte);
}

static avr_cycle_count_t byte_ended(avr_t *avr, avr_cycle_count_t when, void *param)
{
	struct uart *uart = param;

	(void)avr;
	if (uart->queue_length == 0) {
		uart->line_busy = false;
		return 0;
	}
	const avr_cycle_count_t byte_time = set_byte_time(uart);
	start_byte(uart);
	return when + byte_time;
}

static void start_line(struct uart *uart)
{
	uart->line_busy = true;
	const avr_cycle_count_t byte_time = set_byte_time(uart);
	start_byte(uart);
	avr_cycle_timer_register(uart->avr, byte_time, byte_ended, uart);
}

static void byte_sent(avr_irq_t *irq, uint32_t value, void *param)
{
	struct uart *uart = param;

	(void)irq;
	set_byte_time(uart); /* before simavr reckons when this byte will have left */
	if (uart->sent_length < UART_SENT_BYTES)
		uart->sent[uart->sent_length++] = (uint8_t)value;
}

bool uart_init(struct uart *uart, avr_t *avr, struct trace *trace)
{
	*uart = (struct uart){.avr = avr, .port = find_port(avr), .trace = trace};
	if (!uart->port)
		return false;
	uart->port->flags = 0; /* no copy of the bytes on our stdout, no sleep while the AVR polls */
	uart->input = uart->port->io.irq + UART_IRQ_INPUT;
	avr_irq_register_notify(uart->port->io.irq + UART_IRQ_OUTPUT, byte_sent, uart);
	return true;
}

size_t uart_room(const struct uart *uart)
{
	return UART_QUEUE_BYTES - uart->queue_length;
}

void uart_receive(struct uart *uart, const uint8_t *bytes, size_t length)
{
	for (size_t i = 0; i < length; i++) {
		uart->queue[(uart->queue_start + uart->queue_length) % UART_QUEUE_BYTES] = bytes[i];
		uart->queue_length++;
	}
	if (length > 0)
		trace_event(uart->trace, uart->avr->cycle, "uart-in %zu", length);
	if (!uart->line_busy && uart->queue_length > 0)
		start_line(uart);
}

void uart_reset(struct uart *uart)
{
	uart->queue_length = 0;
	uart->line_busy = false;
}

void uart_keep_going(struct uart *uart)
{
	if (!uart->line_busy || avr_cycle_timer_status(uart->avr, byte_ended, uart) != 0)
		return;
	uart->line_busy = false;
	uart_receive(uart, NULL, 0);
}

void uart_clear_sent(struct uart *uart)
{
	if (uart->sent_length > 0)
		trace_event(uart->trace, uart->avr->cycle, "uart-out %zu", uart->sent_length);
	uart->sent_length = 0;
}
