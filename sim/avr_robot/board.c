#include "board.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/sim_avr.h>

enum {
	RIGHT_SHIFT = 4,        /* PD4..7 */
	A0_PIN = 0,             /* PC0 */
	DDRC = 0x27,            /* of the ATmega328P */
	PORTC = 0x28,
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

	update_wheel(board, &board->left, b->level & b->output);
	update_wheel(board, &board->right, (uint8_t)(d->level & d->output) >> RIGHT_SHIFT);
	emitter_drive(&board->emitter, d->level, d->output);
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

static avr_irq_t *adc_irq(avr_t *avr, int index)
{
	return avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, index);
}

/* A pin to which nothing is connected shows the supply while its pull-up is on. */
static void conversion_started(avr_irq_t *irq, uint32_t value, void *param)
{
	const struct board *board = param;
	const struct voltages *voltages = &board->voltages;
	const bool pulled_up = board->avr->data[PORTC] & ~board->avr->data[DDRC] & 1u << A0_PIN;

	(void)irq;
	(void)value;
	avr_raise_irq(adc_irq(board->avr, ADC_IRQ_ADC0), voltages->a0 == 0 && pulled_up ? voltages->supply : voltages->a0);
}

static void connect_voltages(struct board *board)
{
	avr_t *avr = board->avr;

	avr->vcc = avr->avcc = avr->aref = board->voltages.supply;
	avr_irq_register_notify(adc_irq(avr, ADC_IRQ_OUT_TRIGGER), conversion_started, board);
}

bool board_init(struct board *board, const struct firmware_image *image, const struct board_options *options,
                struct trace *trace)
{
	*board = (struct board){
		.trace = trace, .voltages = options->voltages, .left = {.name = "left"}, .right = {.name = "right"}};
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
	connect_voltages(board);
	emitter_init(&board->emitter, avr, trace);
	receiver_init(&board->receiver, avr, options->demodulates, trace);
	avr_irq_register_notify(port_irq(avr, 'B', IOPORT_IRQ_REG_PORT), port_b_level, board);
	avr_irq_register_notify(port_irq(avr, 'B', IOPORT_IRQ_DIRECTION_ALL), port_b_output, board);
	avr_irq_register_notify(port_irq(avr, 'D', IOPORT_IRQ_REG_PORT), port_d_level, board);
	avr_irq_register_notify(port_irq(avr, 'D', IOPORT_IRQ_DIRECTION_ALL), port_d_output, board);
	return true;
}

/* simavr clears the registers, but those who listen to its ports hear nothing of it. */
static void finish_reset(struct board *board, uint64_t cycle, const char *cause)
{
	avr_t *avr = board->avr;

	avr->cycle = cycle; /* newer versions of simavr count from 0 again */
	trace_event(board->trace, cycle, "reset %s", cause);
	for (const char *port = "BD"; *port; port++) {
		avr_raise_irq(port_irq(avr, *port, IOPORT_IRQ_DIRECTION_ALL), 0);
		avr_raise_irq(port_irq(avr, *port, IOPORT_IRQ_REG_PORT), 0);
	}
	emitter_reset(&board->emitter);
	receiver_reset(&board->receiver);
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

	receiver_keep_going(&board->receiver);
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
