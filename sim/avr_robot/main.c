/* A virtual robot's hardware in real time: the board, its serial cable, and its contact with the arena. */
#include "arena_link.h"
#include "board.h"
#include "bootloader.h"
#include "options.h"
#include "priority.h"
#include "serial_line.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum {
	SLICE_NS = 1000000,               /* the AVR runs in slices of 1 ms, then waits for the clock */
	SLICE_CYCLES = AVR_HZ / 1000,
	LIGHTS_PER_SLICE = 8,             /* light changes at most every 125 us, so that no pulse is too short to exist */
	CATCH_UP_NS = 100 * SLICE_NS,     /* lost time that is caught up: a busy moment, not a suspended machine */
	NEWS_NS = SLICE_NS / 5,           /* how often the AVR looks for the news of a light that it waits for */
	NEWS_PATIENCE = CATCH_UP_NS / NEWS_NS, /* times */
	TICK_CYCLES = AVR_HZ / 100,       /* of the trace */
	REPORT_EVERY_SLICES = 10000,      /* time given up is reported at most as often */
};

struct robot {
	const struct options *options;
	struct board board;
	struct serial_line *line;
	struct arena_link *arena; /* NULL: none */
	struct trace trace;
};

static int64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* Wait for the start of the slice that is due at `due`; returns the time given up because it was too long ago. */
static int64_t wait_for(int64_t due)
{
	const struct timespec deadline = {.tv_sec = (time_t)(due / 1000000000), .tv_nsec = (long)(due % 1000000000)};
	const int64_t late = now_ns() - due;

	if (late > CATCH_UP_NS)
		return late;
	if (late < 0)
		clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, NULL);
	return 0;
}

static void read_line(struct robot *robot)
{
	uint8_t bytes[UART_QUEUE_BYTES];
	struct uart *uart = &robot->board.uart;
	const size_t length = robot->line->receive(robot->line, bytes, uart_room(uart));

	if (robot->options->bootloader && robot->line->opened(robot->line))
		board_reset(&robot->board); /* before the bytes: they may be the opener's */
	uart_receive(uart, bytes, length);
}

static void write_line(struct robot *robot)
{
	struct uart *uart = &robot->board.uart;

	if (uart->sent_length > 0)
		robot->line->transmit(robot->line, uart->sent, uart->sent_length);
	uart_clear_sent(uart);
}

/* Take what the arena has said: at most one change of plain light, but all edges of carriers, which have times. */
static void see(struct robot *robot)
{
	struct receiver *receiver = &robot->board.receiver;
	struct light_event event;

	while (arena_link_take_light(robot->arena, &event)) {
		switch (event.kind) {
		case LIGHT_DARK: receiver_darken(receiver); return;
		case LIGHT_PLAIN: receiver_shine(receiver, event.on); return;
		case LIGHT_LAMP: receiver_light_lamp(receiver); return;
		case LIGHT_CARRIER:
			if (event.source < LIGHT_SOURCES)
				receiver_carrier(receiver, event.source, event.cycle, event.on);
		}
	}
}

/* A computer that runs this robot now and the shooter later would else damage the shooter's packet. */
static void wait_for_news(struct robot *robot, uint64_t end)
{
	struct receiver *receiver = &robot->board.receiver;

	see(robot);
	for (int patience = NEWS_PATIENCE; receiver_has_to_wait(receiver, end); patience--) {
		if (patience == 0)
			receiver_give_up(receiver);
		else
			nanosleep(&(struct timespec){.tv_nsec = NEWS_NS}, NULL);
		see(robot);
	}
}

static void report(struct robot *robot)
{
	struct board *board = &robot->board;

	emitter_confirm(&board->emitter);
	arena_link_send_edges(robot->arena, board->emitter.edges, board->emitter.edges_length);
	arena_link_publish(robot->arena, board->left.stepper.position, board->right.stepper.position, board->emitter.plain);
}

/* One slice of the robot's life; false if the firmware has ended. */
static bool run_slice(struct robot *robot, uint64_t end)
{
	struct board *board = &robot->board;
	bool alive = true;

	if (robot->arena)
		wait_for_news(robot, end);
	read_line(robot);
	for (int part = LIGHTS_PER_SLICE - 1; part >= 0 && alive; part--) {
		if (robot->arena)
			see(robot);
		alive = board_run_until(board, end - (uint64_t)part * (SLICE_CYCLES / LIGHTS_PER_SLICE));
	}
	write_line(robot);
	if (robot->arena)
		report(robot);
	emitter_clear_edges(&board->emitter);
	if (end % TICK_CYCLES == 0)
		trace_event(&robot->trace, end, "tick");
	trace_flush(&robot->trace);
	return alive;
}

static void report_lost(const struct robot *robot, int64_t *lost_ns)
{
	if (*lost_ns > 0)
		fprintf(stderr, "avr_robot %s: this computer stood still or is too slow: %" PRId64 " ms skipped\n",
		        robot->options->name, *lost_ns / 1000000);
	*lost_ns = 0;
}

/* Run until SIGINT or SIGTERM (0) or until the firmware ends (1). */
static int live(struct robot *robot, const sigset_t *end_signals)
{
	int64_t start = now_ns(), lost = 0;

	for (int64_t slice = 0; sigtimedwait(end_signals, NULL, &(struct timespec){0}) < 0; slice++) {
		const int64_t late = wait_for(start + slice * SLICE_NS);
		start += late;
		lost += late;
		if (slice % REPORT_EVERY_SLICES == 0)
			report_lost(robot, &lost);
		if (!run_slice(robot, (uint64_t)(slice + 1) * SLICE_CYCLES))
			return 1;
	}
	return 0;
}

int main(int argc, char **argv)
{
	const struct options options = options_parse(argc, argv);
	struct robot robot = {.options = &options, .trace = {.out = options.trace ? stdout : NULL}};
	struct firmware_image *image = malloc(sizeof *image);
	sigset_t end_signals;

	/* taken from sigtimedwait(), so that nothing is ever interrupted halfway; before any thread starts */
	sigemptyset(&end_signals);
	sigaddset(&end_signals, SIGINT);
	sigaddset(&end_signals, SIGTERM);
	sigprocmask(SIG_BLOCK, &end_signals, NULL);
	signal(SIGPIPE, SIG_IGN);

	if (!image || !firmware_image_read(image, options.firmware) ||
	    (options.bootloader && !bootloader_read(image, options.bootloader)) ||
	    !board_init(&robot.board, image, &options.board, &robot.trace))
		return 1;
	free(image);
	robot.line = options.tcp ? serial_tcp_open(&options.listen) : serial_pty_open(options.pty_link, options.bootloader);
	if (!robot.line)
		return 2;
	priority_take(); /* before the arena's thread starts */
	if (options.arena && !(robot.arena = arena_link_start(&options.arena_address, options.name)))
		return 1;
	fprintf(stderr, "avr_robot %s: UART at %s\n", options.name, robot.line->address);
	trace_event(&robot.trace, 0, "ready");
	trace_flush(&robot.trace);

	const int code = live(&robot, &end_signals);
	robot.line->close(robot.line);
	exit(code); /* not return: the arena's thread may be waiting for a name and needs nothing of ours */
}
