/* The host's end of the serial cable: a pseudo terminal or a TCP port. Never blocks. */
#ifndef AVR_ROBOT_SERIAL_LINE_H
#define AVR_ROBOT_SERIAL_LINE_H

#include "options.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SERIAL_DESCRIPTORS = 3 };

struct serial_line {
	/* Up to `size` bytes that the host has sent; 0 if none. */
	size_t (*receive)(struct serial_line *line, uint8_t *bytes, size_t size);
	/*
	 * Whether another program has opened the port since the last call. Ask after receive(): then no byte of that program
	 * has been received in an earlier round.
	 */
	bool (*opened)(struct serial_line *line);
	/* Bytes for the host. What does not fit, or nobody listens to, is lost as on a real cable. */
	void (*transmit)(struct serial_line *line, const uint8_t *bytes, size_t length);
	/* Descriptors that are readable when receive() or opened() has news, and -1 for none. */
	void (*watch)(const struct serial_line *line, int descriptors[SERIAL_DESCRIPTORS]);
	/* Leave nothing behind and free `line`. */
	void (*close)(struct serial_line *line);
	char address[512]; /* for people */
};

/*
 * A pseudo terminal behind the symlink `link`, which notices openings if `watched`; NULL with a line on stderr if that
 * cannot be made.
 */
struct serial_line *serial_pty_open(const char *link, bool watched);

/* A TCP port with one client at a time; NULL with a line on stderr if it cannot be had. */
struct serial_line *serial_tcp_open(const struct address *at);

#endif
