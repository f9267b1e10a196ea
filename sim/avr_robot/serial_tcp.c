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

struct serial_tcp {
	struct serial_line line;
	int listener;
	int client; /* -1: nobody */
	bool fresh; /* a client has come and opened() has not told yet */
};

static void drop_client(struct serial_tcp *tcp)
{
	if (tcp->client >= 0)
		close(tcp->client);
	tcp->client = -1;
}

/* The newest client is the one: an older one may be a connection whose host has long vanished. */
static void accept_clients(struct serial_tcp *tcp)
{
	const int on = 1;
	int client;

	while ((client = accept4(tcp->listener, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0) {
		drop_client(tcp);
		tcp->client = client;
		tcp->fresh = true;
		setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
	}
}

static size_t tcp_receive(struct serial_line *line, uint8_t *bytes, size_t size)
{
	struct serial_tcp *tcp = (struct serial_tcp *)line;
	struct pollfd ready[2] = {{.fd = tcp->listener, .events = POLLIN}, {.fd = tcp->client, .events = POLLIN}};

	if (poll(ready, 2, 0) <= 0)
		return 0;
	if (ready[0].revents)
		accept_clients(tcp);
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

	descriptors[0] = tcp->listener;
	descriptors[1] = tcp->client;
}

static void tcp_close(struct serial_line *line)
{
	struct serial_tcp *tcp = (struct serial_tcp *)line;

	drop_client(tcp);
	if (tcp->listener >= 0)
		close(tcp->listener);
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
	if (bind(listener, candidate->ai_addr, candidate->ai_addrlen) == 0 && listen(listener, 4) == 0)
		return listener;
	const int reason = errno;
	close(listener);
	errno = reason;
	return -1;
}

static void name_address(struct serial_tcp *tcp, const char *host)
{
	struct sockaddr_storage own;
	socklen_t length = sizeof own;
	char port[6] = "?";

	if (getsockname(tcp->listener, (struct sockaddr *)&own, &length) == 0)
		getnameinfo((struct sockaddr *)&own, length, NULL, 0, port, sizeof port, NI_NUMERICSERV);
	snprintf(tcp->line.address, sizeof tcp->line.address, strchr(host, ':') ? "[%s]:%s" : "%s:%s", host, port);
}

struct serial_line *serial_tcp_open(const struct address *listen_at)
{
	const struct addrinfo wanted = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_PASSIVE | AI_NUMERICSERV};
	struct addrinfo *found = NULL;
	struct serial_tcp *tcp = calloc(1, sizeof *tcp);

	if (!tcp)
		return NULL;
	*tcp = (struct serial_tcp){
		.line = {.receive = tcp_receive,
		         .opened = tcp_opened,
		         .transmit = tcp_transmit,
		         .watch = tcp_watch,
		         .close = tcp_close},
		.listener = -1,
		.client = -1,
	};
	const int fault = getaddrinfo(listen_at->host, listen_at->port, &wanted, &found);
	for (const struct addrinfo *next = found; next && tcp->listener < 0; next = next->ai_next)
		tcp->listener = listen_on(next);
	if (tcp->listener < 0) {
		fprintf(stderr, "avr_robot: --tcp %s:%s: %s; choose another address or port\n", listen_at->host,
		        listen_at->port, fault ? gai_strerror(fault) : strerror(errno));
		tcp_close(&tcp->line);
		tcp = NULL;
	} else {
		name_address(tcp, listen_at->host);
	}
	if (found)
		freeaddrinfo(found);
	return tcp ? &tcp->line : NULL;
}
