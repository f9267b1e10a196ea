#include "board.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_interrupts.h>

DEFINE_FIFO(avr_int_vector_p, avr_int_pending);

enum {
	SENSOR_PIN = 2,      /* PD2 */
	EMITTER_PIN = 3,     /* PD3 */
	RIGHT_SHIFT = 4,     /* PD4..7 */
	INT0_VECTOR = 1,     /* of the ATmega328P */
	EMITTER_INT = 1,     /* PD3 is INT1's pin, too */
	UNCHECKED_CYCLES = 256, /* simavr looks up from the program at most as late: twice as fast */
};

static void log_to_stderr(avr_t *avr, const int level, const char *format, va_list words)
{
	(void)avr;
	if (level > LOG_ERROR)
		return;
	fputs("avr_robot: simavr: ", stderr);
	vfprintf(stderr, format, words);
}

static void update_wheel(struct board *board, struct wheel *wheel, uint8_t pattern)
{
	const uint64_t now = board->avr->cycle;

	switch (stepper_update(&wheel->stepper, pattern)) {
	case STEPPER_STILL: break;
	case STEPPER_STEP: trace_event(board->trace, now, "coil %s %" PRId64, wheel->name, wheel->stepper.position); break;
	case STEPPER_SLIP: trace_event(board->trace, now, "slip %s", wheel->name); break;
	case STEPPER_ENERGISED: trace_event(board->trace, now, "coils %s on", wheel->name); break;
	case STEPPER_RELEASED: trace_event(board->trace, now, "coils %s off", wheel->name); break;
	}
}

static void update_outputs(struct board *board)
{
	const struct port *b = &board->port_b, *d = &board->port_d;
	const bool beam = (d->output & ~d->level) >> EMITTER_PIN & 1;

	update_wheel(board, &board->left, b->level & b->output);
	update_wheel(board, &board->right, (uint8_t)(d->level & d->output) >> RIGHT_SHIFT);
	if (beam != board->beam) {
		board->beam = beam;
		trace_event(board->trace, board->avr->cycle, "beam %d", beam);
	}
}

static void port_b_level(avr_irq_t *irq, uint32_t value, void *param)
{
	struct board *board = param;
	(void)irq;
	board->port_b.level = (uint8_t)value;
	update_outputs(board);
}

static void port_b_output(avr_irq_t *irq, uint32_t value, void *param)
{
	struct board *board = param;
	(void)irq;
	board->port_b.output = (uint8_t)value;
	update_outputs(board);
}

static void port_d_level(avr_irq_t *irq, uint32_t value, void *param)
{
	struct board *board = param;
	(void)irq;
	board->port_d.level = (uint8_t)value;
	update_outputs(board);
}

static void port_d_output(avr_irq_t *irq, uint32_t value, void *param)
{
	struct board *board = param;
	(void)irq;
	board->port_d.output = (uint8_t)value;
	update_outputs(board);
}

static void no_sleep(avr_t *avr, avr_cycle_count_t how_long)
{
	(void)avr; /* the caller of board_run_until() does the pacing */
	(void)how_long;
}

static avr_irq_t *port_irq(avr_t *avr, char port, int index)
{
	return avr_io_getirq(avr, (uint32_t)AVR_IOCTL_IOPORT_GETIRQ(port), index);
}

static void drive_sensor_pin(struct board *board)
{
	/* Without the "external" level simavr takes the pull-up's at every write to the port, even in the dark. */
	avr_ioport_external_t level = {
		.name = 'D',
		.mask = 1u << SENSOR_PIN,
		.value = board->light ? 0 : 1u << SENSOR_PIN,
	};
	avr_ioctl(board->avr, (uint32_t)AVR_IOCTL_IOPORT_SET_EXTERNAL('D'), &level);
	avr_raise_irq(board->sensor_pin, !board->light);
}

/* While its pin is low simavr would look at INT1 in each cycle, ten times the work, though nobody enables it. */
static void ignore_emitter_interrupt(avr_t *avr)
{
	avr_extint_set_strict_lvl_trig(avr, EMITTER_INT, 0);
}

static bool queued(avr_int_table_t *table, const avr_int_vector_t *vector)
{
	const int length = avr_int_pending_get_read_size(&table->pending);

	for (int i = 0; i < length; i++)
		if (avr_int_pending_read_at(&table->pending, (uint16_t)i) == vector)
			return true;
	return false;
}

/*
 * Two faults of simavr would make the robot miss light. Under a flood of edges INT0 can stay marked as pending though it
 * is not in the queue: deaf for ever. And an edge that comes while INT0 is masked only sets its flag; the real AVR serves
 * it when INT0 is unmasked.
 */
static void revive_sensor_interrupt(struct board *board)
{
	avr_t *avr = board->avr;
	avr_int_vector_t *vector = board->sensor_interrupt;
	const bool latched = avr_regbit_get(avr, vector->raised) && avr_regbit_get(avr, vector->enable);

	if ((vector->pending || latched) && !queued(&avr->interrupts, vector)) {
		avr_clear_interrupt(avr, vector);
		avr_raise_interrupt(avr, vector);
	}
}

/* after the write */
static void interrupt_mask_written(avr_irq_t *irq, uint32_t value, void *param)
{
	(void)irq;
	(void)value;
	revive_sensor_interrupt(param);
}

static avr_int_vector_t *find_interrupt(avr_t *avr, int number)
{
	for (int i = 0; i < avr->interrupts.vector_count; i++)
		if (avr->interrupts.vector[i]->vector == number)
			return avr->interrupts.vector[i];
	return NULL;
}

static void attach_sensor(struct board *board)
{
	avr_t *avr = board->avr;

	board->sensor_pin = port_irq(avr, 'D', SENSOR_PIN);
	board->sensor_interrupt = find_interrupt(avr, INT0_VECTOR);
	avr_irq_register_notify(avr_iomem_getirq(avr, board->sensor_interrupt->enable.reg, NULL, AVR_IOMEM_IRQ_ALL),
	                        interrupt_mask_written, board);
	drive_sensor_pin(board);
}

bool board_init(struct board *board, const struct firmware_image *image, struct trace *trace)
{
	*board = (struct board){.trace = trace, .left = {.name = "left"}, .right = {.name = "right"}};
	stepper_init(&board->left.stepper);
	stepper_init(&board->right.stepper);

	avr_global_logger_set(log_to_stderr);
	avr_t *avr = avr_make_mcu_by_name("atmega328p");
	if (!avr || avr_init(avr) != 0) {
		fputs("avr_robot: this simavr has no ATmega328P\n", stderr);
		return false;
	}
	board->avr = avr;
	avr->frequency = AVR_HZ;
	avr->sleep = no_sleep;
	memcpy(avr->flash, image->flash, image->size);
	avr->codeend = image->size;
	avr->reset_pc = avr->pc = image->start;
	board->run = avr->run;
	if (!uart_init(&board->uart, avr, trace)) {
		fputs("avr_robot: this simavr has no UART0\n", stderr);
		return false;
	}
	avr_irq_register_notify(port_irq(avr, 'B', IOPORT_IRQ_REG_PORT), port_b_level, board);
	avr_irq_register_notify(port_irq(avr, 'B', IOPORT_IRQ_DIRECTION_ALL), port_b_output, board);
	avr_irq_register_notify(port_irq(avr, 'D', IOPORT_IRQ_REG_PORT), port_d_level, board);
	avr_irq_register_notify(port_irq(avr, 'D', IOPORT_IRQ_DIRECTION_ALL), port_d_output, board);
	attach_sensor(board);
	ignore_emitter_interrupt(avr);
	return true;
}

/* simavr clears the registers, but those who listen to its ports hear nothing of it. */
static void finish_reset(struct board *board, uint64_t cycle, const char *cause)
{
	avr_t *avr = board->avr;

	avr->cycle = cycle; /* newer versions of simavr count from 0 again */
	ignore_emitter_interrupt(avr);
	trace_event(board->trace, cycle, "reset %s", cause);
	for (const char *port = "BD"; *port; port++) {
		avr_raise_irq(port_irq(avr, *port, IOPORT_IRQ_DIRECTION_ALL), 0);
		avr_raise_irq(port_irq(avr, *port, IOPORT_IRQ_REG_PORT), 0);
	}
	board->sensor_pin->flags |= IRQ_FLAG_INIT; /* the pin's register needs the level, though it has not changed */
	drive_sensor_pin(board);
}

void board_reset(struct board *board)
{
	avr_t *avr = board->avr;
	const uint64_t cycle = avr->cycle;

	avr_reset(avr);
	avr_regbit_set(avr, avr->reset_flags.extrf);
	finish_reset(board, cycle, "opened");
	uart_reset(&board->uart);
}

static int run(struct board *board)
{
	avr_t *avr = board->avr;
	const uint64_t cycle = avr->cycle;
	const bool reset = avr->run != board->run;

	const int state = avr_run(avr);
	if (reset)
		finish_reset(board, cycle, "watchdog");
	return state;
}

bool board_run_until(struct board *board, uint64_t cycle)
{
	avr_t *avr = board->avr;

	revive_sensor_interrupt(board);
	uart_keep_going(&board->uart);
	avr->run_cycle_limit = UNCHECKED_CYCLES; /* a reset of the AVR sets it to 1 */
	while (avr->cycle < cycle) {
		const int state = run(board);
		if (state == cpu_Done || state == cpu_Crashed) {
			fprintf(stderr, "avr_robot: the firmware %s at address 0x%04" PRIx32 " after %" PRIu64 " cycles\n",
			        state == cpu_Done ? "has put the AVR to sleep for ever" : "has crashed", avr->pc,
			        (uint64_t)avr->cycle);
			return false;
		}
	}
	return true;
}

void board_set_light(struct board *board, bool light)
{
	if (light == board->light)
		return;
	board->light = light;
	trace_event(board->trace, board->avr->cycle, "light %d", light);
	drive_sensor_pin(board);
}
