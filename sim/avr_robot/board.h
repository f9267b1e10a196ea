/*
 * The Arduino Uno with what hangs on its pins: two steppers (left PB0..3 = pins 8..11, right PD4..7 = pins 4..7), the
 * infrared emitter (PD3 = pin 3), the receiver (PD2 = pin 2) and perhaps a battery's divider (A0).
 */
#ifndef AVR_ROBOT_BOARD_H
#define AVR_ROBOT_BOARD_H

#include "emitter.h"
#include "firmware_image.h"
#include "options.h"
#include "receiver.h"
#include "stepper.h"
#include "trace.h"
#include "uart.h"

#include <stdbool.h>
#include <stdint.h>

enum { AVR_HZ = 16000000 };

struct avr_t;

struct port {
	uint8_t level;  /* PORT register */
	uint8_t output; /* DDR register */
};

struct wheel {
	const char *name;
	struct stepper stepper;
};

struct board {
	struct avr_t *avr;
	void (*run)(struct avr_t *avr); /* simavr's way to run it, unless its watchdog wants a reset */
	struct trace *trace;
	struct voltages voltages;
	struct uart uart;
	struct port port_b, port_d;
	struct wheel left, right;
	struct emitter emitter;
	struct receiver receiver;
};

/* Power on with `image` in the flash; false with a line on stderr if the simulator cannot do it. */
bool board_init(struct board *board, const struct firmware_image *image, const struct board_options *options,
                struct trace *trace);

/* Execute until `cycle` cycles after power-on; false if the program has crashed or stopped. */
bool board_run_until(struct board *board, uint64_t cycle);

/* The reset that an Uno gets when its serial port is opened; what is on its way to the AVR is lost. */
void board_reset(struct board *board);

#endif
