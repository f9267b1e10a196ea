#include "serial_line.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

struct serial_pty {
	struct serial_line line;
	int master;
	int slave;        /* kept open: without any slave the master reports errors and loses the terminal's settings */
	char device[64];  /* /dev/pts/N */
	int openings;     /* inotify, or -1 */
	char *link;       /* NULL until it exists */
};

static size_t pty_receive(struct serial_line *line, uint8_t *bytes, size_t size)
{
	const struct serial_pty *pty = (struct serial_pty *)line;
	const ssize_t length = read(pty->master, bytes, size);

	return length > 0 ? (size_t)length : 0;
}

/* On the device itself, so that it does not matter by which path or in which container it is opened. */
static bool watch_openings(struct serial_pty *pty)
{
	pty->openings = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
	return pty->openings >= 0 && inotify_add_watch(pty->openings, pty->device, IN_OPEN) >= 0;
}

static bool pty_opened(struct serial_line *line)
{
	const struct serial_pty *pty = (struct serial_pty *)line;
	_Alignas(struct inotify_event) char events[1024];
	bool opened = false;

	while (read(pty->openings, events, sizeof events) > 0)
		opened = true;
	if (opened)
		tcflush(pty->slave, TCIFLUSH); /* the new opener must not get what came before */
	return opened;
}

static void pty_transmit(struct serial_line *line, const uint8_t *bytes, size_t length)
{
	const struct serial_pty *pty = (struct serial_pty *)line;

	if (write(pty->master, bytes, length) < 0) {
		/* full: nobody reads, and the oldest bytes are of no use to whoever opens the port later */
		tcflush(pty->slave, TCIFLUSH);
	}
}

static void pty_watch(const struct serial_line *line, int descriptors[SERIAL_DESCRIPTORS])
{
	const struct serial_pty *pty = (const struct serial_pty *)line;

	descriptors[0] = pty->master;
	descriptors[1] = pty->openings;
	descriptors[2] = -1;
}

static void pty_close(struct serial_line *line)
{
	struct serial_pty *pty = (struct serial_pty *)line;
	char target[sizeof pty->device];

	if (pty->link) {
		const ssize_t length = readlink(pty->link, target, sizeof target);
		/* a robot started later may have taken the link over */
		if (length == (ssize_t)strlen(pty->device) && memcmp(target, pty->device, (size_t)length) == 0)
			unlink(pty->link);
	}
	free(pty->link);
	if (pty->openings >= 0)
		close(pty->openings);
	if (pty->slave >= 0)
		close(pty->slave);
	if (pty->master >= 0)
		close(pty->master);
	free(pty);
}

/* Put `link` -> device in place in one step, so that nobody ever sees a half-made one. */
static bool make_link(struct serial_pty *pty, const char *link)
{
	char temporary[4096];
	struct stat existing;

	if (lstat(link, &existing) == 0 && !S_ISLNK(existing.st_mode)) {
		fprintf(stderr, "avr_robot: --serial %s: is not a symlink; remove it or choose another path\n", link);
		return false;
	}
	const int length = snprintf(temporary, sizeof temporary, "%s.%ld", link, (long)getpid());
	if (length < 0 || (size_t)length >= sizeof temporary) {
		fprintf(stderr, "avr_robot: --serial: the path is too long\n");
		return false;
	}
	unlink(temporary);
	if (symlink(pty->device, temporary) != 0 || rename(temporary, link) != 0) {
		fprintf(stderr, "avr_robot: --serial %s: cannot make the link: %s\n", link, strerror(errno));
		unlink(temporary);
		return false;
	}
	pty->link = strdup(link);
	return pty->link;
}

static bool open_terminal(struct serial_pty *pty)
{
	struct termios settings;

	pty->master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
	if (pty->master < 0 || grantpt(pty->master) != 0 || unlockpt(pty->master) != 0 ||
	    ptsname_r(pty->master, pty->device, sizeof pty->device) != 0)
		return false;
	pty->slave = open(pty->device, O_RDWR | O_NOCTTY | O_CLOEXEC);
	if (pty->slave < 0 || tcgetattr(pty->slave, &settings) != 0)
		return false;
	cfmakeraw(&settings); /* no echo, no line editing, no CR/LF or signal characters */
	cfsetspeed(&settings, B57600);
	return tcsetattr(pty->slave, TCSANOW, &settings) == 0;
}

struct serial_line *serial_pty_open(const char *link, bool watched)
{
	struct serial_pty *pty = calloc(1, sizeof *pty);

	if (!pty)
		return NULL;
	*pty = (struct serial_pty){
		.line = {.receive = pty_receive,
		         .opened = pty_opened,
		         .transmit = pty_transmit,
		         .watch = pty_watch,
		         .close = pty_close},
		.master = -1,
		.slave = -1,
		.openings = -1,
	};
	snprintf(pty->line.address, sizeof pty->line.address, "%s", link);
	if (!open_terminal(pty)) {
		fprintf(stderr, "avr_robot: cannot open a pseudo terminal: %s\n", strerror(errno));
		pty_close(&pty->line);
		return NULL;
	}
	if (watched && !watch_openings(pty)) {
		fprintf(stderr, "avr_robot: cannot watch the pseudo terminal: %s\n", strerror(errno));
		pty_close(&pty->line);
		return NULL;
	}
	if (!make_link(pty, link)) {
		pty_close(&pty->line);
		return NULL;
	}
	return &pty->line;
}
