/* A virtual robot's hardware in real time: the board, its serial cable, and its contact with the arena. */
#include "arena_link.h"
#include "board.h"
#include "bootloader.h"
#include "options.h"
#include "priority.h"
#include "serial_line.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <simavr/sim_avr.h>

enum {
	SLICE_NS = 1000000,               /* the AVR runs in slices of 1 ms, then waits for the clock */
	SLICE_CYCLES = AVR_HZ / 1000,
	LIGHTS_PER_SLICE = 8,             /* light changes at most every 125 us, so that no pulse is too short to exist */
	CATCH_UP_NS = 100 * SLICE_NS,     /* lost time that is caught up: a busy moment, not a suspended machine */
	NEWS_NS = SLICE_NS / 5,           /* how often the AVR looks for the news of a light that it waits for */
	NEWS_PATIENCE = CATCH_UP_NS / NEWS_NS, /* times */
	DOZE_SLICES = 2,                  /* a robot to which nothing happens lives so many slices at once */
	QUIET_CYCLES = AVR_HZ / 10,       /* after so long without an event */
	SIGNALS_EVERY_SLICES = 10,
	TICK_CYCLES = AVR_HZ / 100,       /* of the trace */
	REPORT_EVERY_SLICES = 10000,      /* time given up is reported at most as often */
};

struct robot {
	const struct options *options;
	struct board board;
	struct serial_line *line;
	struct arena_link *arena; /* NULL: none */
	struct trace trace;
	uint64_t quiet_from; /* cycle, unless something happens before */
	bool dozed;          /* it has dozed, and nothing has come in */
};

static int64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void stay_awake(struct robot *robot)
{
	robot->quiet_from = robot->board.avr->cycle + QUIET_CYCLES;
}

/* Whether the robot does something by itself that others see, or is going to. */
static bool is_active(const struct board *board)
{
	const struct emitter *emitter = &board->emitter;
	const struct receiver *receiver = &board->receiver;

	return board->uart.sent_length > 0 || board->uart.line_busy || board->left.stepper.pattern ||
	       board->right.stepper.pattern || emitter->plain || emitter->in_packet || receiver->edges_length > 0 ||
	       receiver->lamp;
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

/*
 * Wait until `due`, or until something comes in; returns whether nothing has. So a robot that dozes hears and sees as soon
 * as one that is awake, and what it says by itself comes up to a slice later.
 */
static bool doze(const struct robot *robot, int64_t due)
{
	const int64_t time = due - now_ns();
	struct pollfd news[SERIAL_DESCRIPTORS + 1] = {{.fd = robot->arena ? arena_link_descriptor(robot->arena) : -1}};
	int line[SERIAL_DESCRIPTORS];

	if (time <= 0)
		return false;
	robot->line->watch(robot->line, line);
	for (size_t i = 0; i < SERIAL_DESCRIPTORS; i++)
		news[i + 1].fd = line[i];
	for (size_t i = 0; i < SERIAL_DESCRIPTORS + 1; i++)
		news[i].events = POLLIN;
	const int events = ppoll(news, SERIAL_DESCRIPTORS + 1, &(struct timespec){.tv_nsec = (long)time}, NULL);
	if (news[0].revents)
		arena_link_await_light(robot->arena);
	return events == 0;
}

static void read_line(struct robot *robot)
{
	uint8_t bytes[UART_QUEUE_BYTES];
	struct uart *uart = &robot->board.uart;
	const size_t length = robot->line->receive(robot->line, bytes, uart_room(uart));

	if (robot->options->bootloader && robot->line->opened(robot->line)) {
		board_reset(&robot->board); /* before the bytes: they may be the opener's */
		stay_awake(robot);
	}
	if (length > 0)
		stay_awake(robot);
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
		stay_awake(robot);
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
	if (!robot->dozed)
		read_line(robot);
	for (int part = LIGHTS_PER_SLICE - 1; part >= 0 && alive; part--) {
		if (robot->arena)
			see(robot);
		alive = board_run_until(board, end - (uint64_t)part * (SLICE_CYCLES / LIGHTS_PER_SLICE));
	}
	if (is_active(board))
		stay_awake(robot);
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

static bool is_to_end(const sigset_t *end_signals)
{
	return sigtimedwait(end_signals, NULL, &(struct timespec){0}) >= 0;
}

/* Run until SIGINT or SIGTERM (0) or until the firmware ends (1). */
static int live(struct robot *robot, const sigset_t *end_signals)
{
	int64_t start = now_ns(), lost = 0;

	for (int64_t slice = 0; slice % SIGNALS_EVERY_SLICES != 0 || !is_to_end(end_signals); slice++) {
		const int64_t due = start + slice * SLICE_NS;
		const bool quiet = robot->board.avr->cycle >= robot->quiet_from;
		if (slice % DOZE_SLICES == 0)
			robot->dozed = quiet && doze(robot, due + (DOZE_SLICES - 1) * SLICE_NS);
		const int64_t late = wait_for(due);
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
