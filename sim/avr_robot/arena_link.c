#include "arena_link.h"

#include "arena_socket.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum {
	LIGHT_EVENTS = 256,    /* more than these wait in the socket */
	EDGES = 256,           /* more than these are lost: an arena that reads nothing */
	EDGE_LINE_BYTES = 32,
	LINE_MAX_BYTES = 256,  /* the longest line that makes sense */
	WHEELS_EVERY_MS = 10,
	RECONNECT_AFTER_MS = 250,
};

struct robot_state {
	int64_t left, right;
	bool beam;
};

struct arena_link {
	struct address arena;
	char robot[ROBOT_NAME_MAX + 1];
	int wake; /* eventfd: there is something to be told */
	int news; /* eventfd: there is light to be seen */

	pthread_mutex_t lock; /* guards what follows */
	struct robot_state state;
	bool attentive; /* the thread looks at the wheels within 10 ms, publishing need not wake it */
	struct carrier_edge edges[EDGES];
	size_t edges_length;
	struct light_event lights[LIGHT_EVENTS]; /* ring */
	size_t lights_start, lights_length;
};

/* One connection; only the thread knows it. */
struct connection {
	int socket;
	char line[LINE_MAX_BYTES];
	size_t line_length;
	struct robot_state told;
};

static struct robot_state current_state(struct arena_link *link)
{
	pthread_mutex_lock(&link->lock);
	const struct robot_state state = link->state;
	pthread_mutex_unlock(&link->lock);
	return state;
}

/* Errors do not matter: the counter is full, or the other thread looks by itself soon. */
static void notify(int event)
{
	const uint64_t one = 1;

	if (write(event, &one, sizeof one) < 0)
		return;
}

static size_t light_room(struct arena_link *link)
{
	pthread_mutex_lock(&link->lock);
	const size_t room = LIGHT_EVENTS - link->lights_length;
	pthread_mutex_unlock(&link->lock);
	return room;
}

static void report_light(struct arena_link *link, struct light_event event)
{
	pthread_mutex_lock(&link->lock);
	if (link->lights_length < LIGHT_EVENTS)
		link->lights[(link->lights_start + link->lights_length++) % LIGHT_EVENTS] = event;
	pthread_mutex_unlock(&link->lock);
	notify(link->news);
}

/* False: the connection is useless. A message that does not fit means an arena that reads nothing. */
static bool tell(const struct connection *connection, const char *message, int length)
{
	return send(connection->socket, message, (size_t)length, MSG_NOSIGNAL | MSG_DONTWAIT) == length;
}

static bool tell_wheels(struct connection *connection, const struct robot_state *state)
{
	char line[64];

	connection->told.left = state->left;
	connection->told.right = state->right;
	return tell(connection, line,
	            snprintf(line, sizeof line, "wheels %" PRId64 " %" PRId64 "\n", state->left, state->right));
}

static bool tell_beam(struct connection *connection, const struct robot_state *state)
{
	connection->told.beam = state->beam;
	return tell(connection, state->beam ? "beam 1\n" : "beam 0\n", 7);
}

static bool tell_edges(struct arena_link *link, const struct connection *connection)
{
	char lines[EDGES * EDGE_LINE_BYTES];
	int length = 0;

	pthread_mutex_lock(&link->lock);
	for (size_t i = 0; i < link->edges_length; i++)
		length += snprintf(lines + length, EDGE_LINE_BYTES, "carrier %d %" PRIu64 "\n", link->edges[i].on,
		                   link->edges[i].cycle);
	link->edges_length = 0;
	pthread_mutex_unlock(&link->lock);
	return length == 0 || tell(connection, lines, length);
}

static void forget_edges(struct arena_link *link)
{
	pthread_mutex_lock(&link->lock);
	link->edges_length = 0;
	pthread_mutex_unlock(&link->lock);
}

static bool say_hello(struct arena_link *link, struct connection *connection)
{
	char line[ROBOT_NAME_MAX + 16];
	const struct robot_state state = current_state(link);

	forget_edges(link);
	return tell(connection, line, snprintf(line, sizeof line, "robot %s\n", link->robot)) &&
	       tell_wheels(connection, &state) && tell_beam(connection, &state);
}

static void obey(struct arena_link *link, const char *line)
{
	struct light_event event = {.kind = LIGHT_CARRIER};
	char on[2];
	int end = 0;

	if (sscanf(line, "carrier %u %1[01] %" SCNu64 "%n", &event.source, on, &event.cycle, &end) == 3 && !line[end]) {
		event.on = on[0] == '1';
		report_light(link, event);
	} else if (strcmp(line, "light 1") == 0 || strcmp(line, "light 0") == 0) {
		report_light(link, (struct light_event){.kind = LIGHT_PLAIN, .on = line[6] == '1'});
	} else if (strcmp(line, "lamp 1") == 0) {
		report_light(link, (struct light_event){.kind = LIGHT_LAMP});
	} else if (strncmp(line, "error ", 6) == 0) {
		fprintf(stderr, "avr_robot %s: the arena says: %s\n", link->robot, line + 6);
	} /* anything else: from a newer arena, perhaps */
}

/* Read whole lines; at most as many bytes as events of light can be kept. False when the arena has gone. */
static bool listen_to_arena(struct arena_link *link, struct connection *connection, size_t room)
{
	char bytes[LIGHT_EVENTS];
	const ssize_t length = recv(connection->socket, bytes, room < sizeof bytes ? room : sizeof bytes, MSG_DONTWAIT);

	if (length == 0)
		return false;
	if (length < 0)
		return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
	for (ssize_t i = 0; i < length; i++) {
		if (bytes[i] != '\n') {
			if (connection->line_length + 1 == sizeof connection->line)
				return false; /* this is not an arena */
			connection->line[connection->line_length++] = bytes[i];
			continue;
		}
		connection->line[connection->line_length] = '\0';
		connection->line_length = 0;
		obey(link, connection->line);
	}
	return true;
}

static bool wheels_differ(const struct robot_state *one, const struct robot_state *other)
{
	return one->left != other->left || one->right != other->right;
}

/* How long the thread may wait for events, in ms; -1: for ever, since publishing wakes it when the wheels turn. */
static int patience(struct arena_link *link, const struct connection *connection, size_t room)
{
	pthread_mutex_lock(&link->lock);
	const bool untold = link->attentive = wheels_differ(&link->state, &connection->told);
	pthread_mutex_unlock(&link->lock);
	return untold || room == 0 ? WHEELS_EVERY_MS : -1;
}

static uint64_t now_us(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static void converse(struct arena_link *link, struct connection *connection)
{
	uint64_t wheels_told = now_us();
	uint64_t beam_changes;

	if (!say_hello(link, connection))
		return;
	for (;;) {
		const size_t room = light_room(link);
		struct pollfd events[2] = {
			{.fd = connection->socket, .events = room ? POLLIN : 0},
			{.fd = link->wake, .events = POLLIN},
		};
		poll(events, 2, patience(link, connection, room));
		if (events[1].revents && read(link->wake, &beam_changes, sizeof beam_changes) < 0)
			return;
		if (events[0].revents && !listen_to_arena(link, connection, room))
			return;
		if (!tell_edges(link, connection))
			return;
		const struct robot_state state = current_state(link);
		if (state.beam != connection->told.beam && !tell_beam(connection, &state))
			return;
		if (wheels_differ(&state, &connection->told) && now_us() - wheels_told >= 1000 * WHEELS_EVERY_MS) {
			wheels_told = now_us();
			if (!tell_wheels(connection, &state))
				return;
		}
	}
}

static void *run(void *param)
{
	struct arena_link *link = param;
	bool missing_told = false;

	for (;;) {
		const char *fault = NULL;
		struct connection connection = {.socket = arena_socket_connect(&link->arena, &fault)};

		if (connection.socket >= 0) {
			missing_told = false;
			fprintf(stderr, "avr_robot %s: in the arena at %s:%s\n", link->robot, link->arena.host, link->arena.port);
			converse(link, &connection);
			fprintf(stderr, "avr_robot %s: the arena has closed the connection; reconnecting\n", link->robot);
			close(connection.socket);
			while (light_room(link) == 0)
				nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
			report_light(link, (struct light_event){.kind = LIGHT_DARK});
		} else if (!missing_told) {
			missing_told = true;
			fprintf(stderr, "avr_robot %s: no arena at %s:%s (%s); looking for it\n", link->robot, link->arena.host,
			        link->arena.port, fault);
		}
		nanosleep(&(struct timespec){.tv_nsec = RECONNECT_AFTER_MS * 1000000L}, NULL);
	}
	return NULL;
}

struct arena_link *arena_link_start(const struct address *arena, const char *robot)
{
	struct arena_link *link = calloc(1, sizeof *link);
	pthread_t thread;

	if (!link)
		return NULL;
	link->arena = *arena;
	snprintf(link->robot, sizeof link->robot, "%s", robot);
	link->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	link->news = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	pthread_mutex_init(&link->lock, NULL);
	if (link->wake < 0 || link->news < 0 || pthread_create(&thread, NULL, run, link) != 0) {
		fprintf(stderr, "avr_robot: cannot start the thread of the arena link: %s\n", strerror(errno));
		free(link);
		return NULL;
	}
	pthread_detach(thread);
	return link;
}

void arena_link_publish(struct arena_link *link, int64_t left, int64_t right, bool beam)
{
	const struct robot_state state = {.left = left, .right = right, .beam = beam};

	pthread_mutex_lock(&link->lock);
	const bool urgent = beam != link->state.beam || (!link->attentive && wheels_differ(&state, &link->state));
	link->state = state;
	link->attentive |= urgent;
	pthread_mutex_unlock(&link->lock);
	if (urgent)
		notify(link->wake);
}

void arena_link_send_edges(struct arena_link *link, const struct carrier_edge *edges, size_t length)
{
	if (length == 0)
		return;
	pthread_mutex_lock(&link->lock);
	for (size_t i = 0; i < length && link->edges_length < EDGES; i++)
		link->edges[link->edges_length++] = edges[i];
	pthread_mutex_unlock(&link->lock);
	notify(link->wake);
}

int arena_link_descriptor(const struct arena_link *link)
{
	return link->news;
}

void arena_link_await_light(struct arena_link *link)
{
	uint64_t events;

	if (read(link->news, &events, sizeof events) < 0)
		return; /* nothing has come */
}

bool arena_link_take_light(struct arena_link *link, struct light_event *event)
{
	pthread_mutex_lock(&link->lock);
	const bool any = link->lights_length > 0;
	if (any) {
		*event = link->lights[link->lights_start];
		link->lights_start = (link->lights_start + 1) % LIGHT_EVENTS;
		link->lights_length--;
	}
	pthread_mutex_unlock(&link->lock);
	return any;
}
