#include "serial_line.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
	LISTENERS = 2, /* one for each family of addresses */
	TRIES = 20, /* to find a port that is free in both */
};

struct serial_tcp {
	struct serial_line line;
	int listeners[LISTENERS]; /* -1: none */
	int client;               /* -1: nobody */
	bool fresh; /* a client has come and opened() has not told yet */
};

static void drop_client(struct serial_tcp *tcp)
{
	if (tcp->client >= 0)
		close(tcp->client);
	tcp->client = -1;
}

/* The newest client is the one: an older one may be a connection whose host has long vanished. */
static void accept_clients(struct serial_tcp *tcp, int listener)
{
	const int on = 1;
	int client;

	while ((client = accept4(listener, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0) {
		drop_client(tcp);
		tcp->client = client;
		tcp->fresh = true;
		setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
	}
}

static size_t tcp_receive(struct serial_line *line, uint8_t *bytes, size_t size)
{
	struct serial_tcp *tcp = (struct serial_tcp *)line;
	struct pollfd ready[LISTENERS + 1] = {{.fd = tcp->client, .events = POLLIN}};

	for (size_t i = 0; i < LISTENERS; i++)
		ready[i + 1] = (struct pollfd){.fd = tcp->listeners[i], .events = POLLIN};
	if (poll(ready, LISTENERS + 1, 0) <= 0)
		return 0;
	for (size_t i = 0; i < LISTENERS; i++)
		if (ready[i + 1].revents)
			accept_clients(tcp, tcp->listeners[i]);
	if (tcp->client < 0 || size == 0)
		return 0;
	const ssize_t length = recv(tcp->client, bytes, size, 0);
	if (length == 0 || (length < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR))
		drop_client(tcp);
	return length > 0 ? (size_t)length : 0;
}

static bool tcp_opened(struct serial_line *line)
{
	struct serial_tcp *tcp = (struct serial_tcp *)line;
	const bool opened = tcp->fresh;

	tcp->fresh = false;
	return opened;
}

static void tcp_transmit(struct serial_line *line, const uint8_t *bytes, size_t length)
{
	const struct serial_tcp *tcp = (struct serial_tcp *)line;

	if (tcp->client >= 0 && send(tcp->client, bytes, length, MSG_NOSIGNAL) < 0)
		return; /* lost; tcp_receive() notices if the client has gone */
}

static void tcp_watch(const struct serial_line *line, int descriptors[SERIAL_DESCRIPTORS])
{
	const struct serial_tcp *tcp = (const struct serial_tcp *)line;

	descriptors[0] = tcp->client;
	for (size_t i = 0; i < LISTENERS; i++)
		descriptors[i + 1] = tcp->listeners[i];
}

static void stop_listening(struct serial_tcp *tcp)
{
	for (size_t i = 0; i < LISTENERS; i++) {
		if (tcp->listeners[i] >= 0)
			close(tcp->listeners[i]);
		tcp->listeners[i] = -1;
	}
}

static void tcp_close(struct serial_line *line)
{
	struct serial_tcp *tcp = (struct serial_tcp *)line;

	drop_client(tcp);
	stop_listening(tcp);
	free(tcp);
}

static int listen_on(const struct addrinfo *candidate)
{
	const int on = 1;
	const int listener =
		socket(candidate->ai_family, candidate->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, candidate->ai_protocol);

	if (listener < 0)
		return -1;
	setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
	if (candidate->ai_family == AF_INET6)
		setsockopt(listener, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
	if (bind(listener, candidate->ai_addr, candidate->ai_addrlen) == 0 && listen(listener, 4) == 0)
		return listener;
	const int reason = errno;
	close(listener);
	errno = reason;
	return -1;
}

/* A socket that listens there, -1 if it cannot be had: then `why`. */
static int listen_at(const char *host, const char *port, const char **why)
{
	const struct addrinfo wanted = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE | AI_NUMERICSERV};
	struct addrinfo *found = NULL;
	const int fault = getaddrinfo(host, port, &wanted, &found);
	int listener = -1;

	for (const struct addrinfo *next = found; next && listener < 0; next = next->ai_next)
		listener = listen_on(next);
	*why = fault ? gai_strerror(fault) : strerror(errno);
	if (found) {
		const int reason = errno;
		freeaddrinfo(found);
		errno = reason;
	}
	return listener;
}

/* Everywhere and on this machine only, in the other family; NULL for any other address. */
static const char *other_family(const char *address)
{
	static const char *const same[][LISTENERS] = {{"0.0.0.0", "::"}, {"127.0.0.1", "::1"}};

	for (size_t i = 0; i < sizeof same / sizeof *same; i++)
		for (size_t j = 0; j < LISTENERS; j++)
			if (strcmp(address, same[i][j]) == 0)
				return same[i][LISTENERS - 1 - j];
	return NULL;
}

/* At both families, as far as the kernel has them: a client of localhost may try only one. False: `why`. */
static bool listen_in_families(struct serial_tcp *tcp, const struct address *at, const char **why)
{
	struct sockaddr_storage own;
	socklen_t length = sizeof own;
	char address[INET6_ADDRSTRLEN], port[6];
	const char *other;

	tcp->listeners[0] = listen_at(at->host, at->port, why);
	if (tcp->listeners[0] < 0)
		return false;
	if (getsockname(tcp->listeners[0], (struct sockaddr *)&own, &length) != 0 ||
	    getnameinfo((struct sockaddr *)&own, length, address, sizeof address, port, sizeof port,
	                NI_NUMERICHOST | NI_NUMERICSERV) != 0 ||
	    (other = other_family(address)) == NULL)
		return true;
	tcp->listeners[1] = listen_at(other, port, why);
	if (tcp->listeners[1] >= 0 || errno == EAFNOSUPPORT || errno == EADDRNOTAVAIL)
		return true;
	stop_listening(tcp);
	return false;
}

static void name_address(struct serial_tcp *tcp, const char *host)
{
	struct sockaddr_storage own;
	socklen_t length = sizeof own;
	char port[6] = "?";

	if (getsockname(tcp->listeners[0], (struct sockaddr *)&own, &length) == 0)
		getnameinfo((struct sockaddr *)&own, length, NULL, 0, port, sizeof port, NI_NUMERICSERV);
	snprintf(tcp->line.address, sizeof tcp->line.address, strchr(host, ':') ? "[%s]:%s" : "%s:%s", host, port);
}

struct serial_line *serial_tcp_open(const struct address *at)
{
	const bool any = strcmp(at->port, "0") == 0;
	const char *why = "";
	struct serial_tcp *tcp = calloc(1, sizeof *tcp);

	if (!tcp)
		return NULL;
	*tcp = (struct serial_tcp){
		.line = {.receive = tcp_receive,
		         .opened = tcp_opened,
		         .transmit = tcp_transmit,
		         .watch = tcp_watch,
		         .close = tcp_close},
		.listeners = {-1, -1},
		.client = -1,
	};
	bool listens = false;
	for (int i = 0; i < (any ? TRIES : 1) && !listens; i++)
		listens = listen_in_families(tcp, at, &why);
	if (!listens) {
		fprintf(stderr, "avr_robot: --tcp %s:%s: %s; choose another address or port\n", at->host, at->port, why);
		tcp_close(&tcp->line);
		return NULL;
	}
	name_address(tcp, at->host);
	return &tcp->line;
}
