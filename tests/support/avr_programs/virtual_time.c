/*
 * The virtual Uno of sim/avr_robot as a library for tests: not paced by the clock but run for as many cycles as a test
 * says, the same each time. tests/support/virtual_time.py is its other half.
 */
#include "board.h"
#include "bootloader.h"

#include <stdlib.h>
#include <string.h>

#include <simavr/sim_avr.h>

static struct trace no_trace;

struct board *uno_new(const char *firmware, const char *bootloader, bool demodulates)
{
	const struct board_options options = {.demodulates = demodulates, .voltages = {.supply = 5000, .a0 = 2000}};
	struct firmware_image *image = malloc(sizeof *image);
	struct board *board = malloc(sizeof *board);

	if (!firmware_image_read(image, firmware) || (bootloader && !bootloader_read(image, bootloader)) ||
	    !board_init(board, image, &options, &no_trace))
		return NULL;
	free(image);
	/* What is not programmed is executed as well, up to the end of the flash. */
	board->avr->codeend = board->avr->flashend;
	return board;
}

uint64_t uno_cycle(const struct board *board)
{
	return board->avr->cycle;
}

/* Behind the end of the flash a real AVR goes on at its beginning. */
void uno_run_until(struct board *board, uint64_t cycle)
{
	while (!board_run_until(board, cycle)) {
		board->avr->pc = 0;
		board->avr->state = cpu_Running;
	}
}

/* How many of the cycles until `cycle` the AVR is awake: instruction by instruction. */
uint64_t uno_awake_until(struct board *board, uint64_t cycle)
{
	avr_t *avr = board->avr;
	uint64_t awake = 0;

	while (avr->cycle < cycle) {
		const uint64_t before = avr->cycle;
		const bool asleep = avr->state == cpu_Sleeping;

		avr->run_cycle_limit = avr->run_cycle_count = 1;
		avr_run(avr);
		if (!asleep)
			awake += avr->state == cpu_Sleeping ? 1 : avr->cycle - before;
	}
	return awake;
}

void uno_receive(struct board *board, const uint8_t *bytes, size_t length)
{
	uart_receive(&board->uart, bytes, length);
}

size_t uno_sent(struct board *board, uint8_t *bytes)
{
	const size_t length = board->uart.sent_length;

	memcpy(bytes, board->uart.sent, length);
	uart_clear_sent(&board->uart);
	return length;
}

/* A carrier at the receiver starts or ends; `cycle` is in its source's time. */
void uno_carrier(struct board *board, uint64_t cycle, bool on)
{
	receiver_carrier(&board->receiver, 0, cycle, on);
}

void uno_shine(struct board *board, bool on)
{
	receiver_shine(&board->receiver, on);
}

bool uno_beam(const struct board *board)
{
	return board->emitter.plain;
}

/* The edges of the own carrier since the last call: cycles, on and off in turn. */
size_t uno_carrier_edges(struct board *board, uint64_t *cycles)
{
	const size_t length = board->emitter.edges_length;

	for (size_t i = 0; i < length; i++)
		cycles[i] = board->emitter.edges[i].cycle;
	emitter_clear_edges(&board->emitter);
	return length;
}

int64_t uno_position(const struct board *board, bool right)
{
	return right ? board->right.stepper.position : board->left.stepper.position;
}

uint8_t uno_peek(const struct board *board, uint16_t address)
{
	return board->avr->data[address];
}

void uno_flip(struct board *board, uint16_t address, uint8_t bit)
{
	board->avr->data[address] ^= 1u << bit;
}

/* By the button. */
void uno_reset(struct board *board)
{
	board_reset(board);
}

/* The program jumps to where there is an endless loop. */
void uno_hang(struct board *board)
{
	const avr_flashaddr_t unused = 0x6000;

	board->avr->flash[unused] = 0xff;
	board->avr->flash[unused + 1] = 0xcf; /* rjmp .-2 */
	board->avr->pc = unused;
}

void uno_delete(struct board *board)
{
	avr_terminate(board->avr);
	free(board);
}
