/* The command line. */
#ifndef AVR_ROBOT_OPTIONS_H
#define AVR_ROBOT_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

enum { ROBOT_NAME_MAX = 32 };

struct address {
	char host[256];
	char port[6]; /* decimal, checked */
};

struct voltages {
	uint32_t supply, a0; /* mV: of the AVR and its ADC; on the pin A0, where 0 is nothing connected */
};

struct board_options {
	bool demodulates; /* its receiver */
	struct voltages voltages;
};

struct options {
	const char *firmware;
	const char *bootloader; /* Intel HEX, or NULL */
	const char *name;
	const char *pty_link;  /* path of the UART's symlink, or NULL */
	bool tcp;              /* UART on a TCP port: */
	struct address listen;
	bool arena;            /* connect to an arena: */
	struct address arena_address;
	struct board_options board;
	bool trace;
};

/* Exits: 0 after --help, 2 with one line on stderr when something is wrong. */
struct options options_parse(int argc, char **argv);

#endif
